"""The types that the objects of a question can have, as far as rules tell them apart.

A rule about vehicles is about cars, too. Only a count tells what type an object really has: what a
car satisfies by facts and by rules about cars, it satisfies as a vehicle that happens to do so. So
a question that finds nothing for the declared types is repeated for the types that are counted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from math import prod
from typing import TypeVar

from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.logic.formula import Count
from rulec.rulebook.rulebook_model import Axiom
from rulec.vocabulary import Vocabulary
from rulec.witnesses.letter_functions import can_be_true, counts_read, plain_body_of
from rulec.witnesses.object_universe import EXTRA, Itself, counts_in
from rulec.witnesses.undecided import UndecidedError

MOST_TYPINGS = 64
"""The most combinations of types for which a question is repeated."""

T = TypeVar("T")


def answers_for_types(
    objects: Mapping[str, str],
    rules: Sequence[AnalyzedRule],
    vocabulary: Vocabulary,
    ask: Callable[[Mapping[str, str]], T],
) -> Iterator[tuple[Mapping[str, str], T | UndecidedError]]:
    """The answers for objects of these types, then of subtypes that counts tell apart.

    Each comes with the types that it is for. An undecided question has its reason as the answer.
    """
    for typing, problem in _typings(objects, rules, vocabulary):
        yield typing, _answer(ask, typing) if problem is None else problem


def _answer(ask: Callable[[Mapping[str, str]], T], typing: Mapping[str, str]) -> T | UndecidedError:
    try:
        return ask(typing)
    except UndecidedError as problem:
        return problem


def _typings(
    objects: Mapping[str, str], rules: Sequence[AnalyzedRule], vocabulary: Vocabulary
) -> Iterator[tuple[Mapping[str, str], UndecidedError | None]]:
    yield objects, None
    counted = dict.fromkeys(count.type for rule in rules for count in _counts_of(rule, vocabulary))
    choices = [
        [kind, *(own for own in counted if own != kind and vocabulary.is_subtype(own, kind))]
        for kind in objects.values()
    ]
    if prod(map(len, choices)) > MOST_TYPINGS:
        problem = "objects of too many different types have to be distinguished"
        yield objects, UndecidedError(problem)
        return
    every = product(*choices)
    next(every)
    for kinds in every:
        yield dict(zip(objects, kinds, strict=True)), None


def _counts_of(rule: AnalyzedRule, vocabulary: Vocabulary) -> Iterator[Count]:
    """The counts of a rule and of its facts to which an object bound to a variable may add."""
    names = [variable.name for variable in rule.rule.variables]
    for count in counts_read(rule.rule.machine.reads):
        if _may_count(count, names, vocabulary):
            yield count
            yield from counts_in(count.body)
    yield from _counts_of_facts(Itself(rule.axioms), Itself(vocabulary))


# Cached: all rules of a rulebook have its facts.
@lru_cache(maxsize=64)
def _counts_of_facts(
    axioms: Itself[tuple[Axiom, ...]], vocabulary: Itself[Vocabulary]
) -> tuple[Count, ...]:
    return tuple(
        count
        for axiom in axioms.item
        for count in counts_in(axiom.formula)
        if _may_count(count, [own.name for own in axiom.variables], vocabulary.item)
    )


def _may_count(count: Count, names: Iterable[str], vocabulary: Vocabulary) -> bool:
    known = Itself(vocabulary)
    bodies = (plain_body_of(count, (name, count.type), known) for name in (*names, EXTRA))
    return any(map(can_be_true, bodies))
