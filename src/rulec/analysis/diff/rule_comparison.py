"""Comparison of two rules by the traces that only one of them forbids.

A trace gives most declarations their defaults; the other values are its reason. Another trace shows
another reason if it avoids at least one non-default declaration of each earlier trace, so it is
searched among the traces where those have their defaults. Which declarations to fix is chosen as
for hitting sets (Reiter 1987), few first, so that simple reasons come first.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Literal

from rulec.analysis.counterexample import (
    Contest,
    shortest_contest,
)
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.shared_vocabulary import shared_vocabulary
from rulec.analysis.trace_display import state_literals
from rulec.monitoring.state_view import value_in
from rulec.rulebook.rulebook_model import Variable
from rulec.trace import Trace
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary
from rulec.witnesses.state_synthesis import subjects_of
from rulec.witnesses.undecided import UndecidedError

RuleRelation = Literal["equal", "stricter", "laxer", "incomparable", "undecided"]
"""The first rule's relation to the second; a stricter rule forbids all the other does, and more."""

MOST_SEARCHES = 12
"""The greatest number of searches for further reasons."""


@dataclass(frozen=True, slots=True)
class RuleComparison:
    """The relation between two rules.

    ``first_forbids`` are traces that the first rule forbids and the second one allows, a shortest
    one first, then shortest ones for other reasons; ``second_forbids`` are the reverse. Either is
    empty if there are none. ``on_common`` is the relation restricted to the ``common`` types of
    objects, if one rule applies to more objects than the other; ``common`` is empty if no object is
    of the types of both, None if the types do not differ or cannot be paired. ``undecided`` is the
    reason why a question was left open.
    """

    __repr__ = short_repr

    relation: RuleRelation
    first_forbids: tuple[Trace, ...] = ()
    second_forbids: tuple[Trace, ...] = ()
    undecided: str = ""
    common: tuple[str, ...] | None = None
    on_common: RuleRelation | None = None


def rule_relation(first: AnalyzedRule, second: AnalyzedRule) -> RuleRelation:
    """The relation between two rules only: ``compare`` without traces to show."""
    if first.law == second.law:
        return "equal"
    try:
        return relation_of(shortest_contest(first, [second]), shortest_contest(second, [first]))
    except UndecidedError:
        return "undecided"


def compare(first: AnalyzedRule, second: AnalyzedRule, most: int = 1) -> RuleComparison:
    """Compare two rules, compiled for one step if they have bounds in seconds.

    In each direction up to ``most`` traces are searched, each for a different reason.
    """
    if first.law == second.law:
        return RuleComparison("equal")
    comparison = _compare(first, second, most)
    if comparison.undecided:
        return comparison
    # A rulebook may lack the types that the other one speaks of.
    words = shared_vocabulary(first.rulebook.vocabulary, second.rulebook.vocabulary)
    common = common_types(first.rule.variables, second.rule.variables, words.vocabulary)
    if not common:
        return replace(comparison, common=common)
    narrow, narrower = (_narrowed(side, common, words.vocabulary) for side in (first, second))
    return replace(comparison, common=common, on_common=rule_relation(narrow, narrower))


def _compare(first: AnalyzedRule, second: AnalyzedRule, most: int) -> RuleComparison:
    try:
        stricter, laxer = shortest_contest(first, [second]), shortest_contest(second, [first])
    except UndecidedError as problem:
        return RuleComparison("undecided", undecided=str(problem))
    return RuleComparison(
        relation_of(stricter, laxer),
        () if stricter is None else plain_witnesses(*stricter, most),
        () if laxer is None else plain_witnesses(*laxer, most),
    )


def plain_witnesses(contest: Contest, first: Trace, most: int) -> tuple[Trace, ...]:
    """Diverse witnesses that can be believed, with few changes, if there are such."""
    plain = _reasons(contest, first)
    contest, first = contest.believable(first)
    traces = diverse_witnesses(contest, first, most, _reasons(contest, first) - plain)
    further = _further_witnesses(contest, traces, most - len(traces))
    names, words = contest.names, contest.vocabulary
    steadied = [contest.steadied(trace) for trace in (*traces, *further)]
    # What differs only in what no rule reads looks the same.
    shown = {tuple(state_literals(trace, names, words)): trace for trace in reversed(steadied)}
    return tuple(reversed(shown.values()))


def _further_witnesses(contest: Contest, traces: Sequence[Trace], most: int) -> Iterator[Trace]:
    """Witnesses in which some number stays within the last limit that it passes in the first one.

    Otherwise a higher limit on a number would hide lower ones that hold under some conditions.
    """
    shown = [_reasons(contest, trace) for trace in traces]
    for nearer in contest.within_limits(traces[0]) if most > 0 else ():
        with suppress(UndecidedError):
            first = nearer.trace()
            for trace in () if first is None else diverse_witnesses(nearer, first, most):
                names = _reasons(contest, trace)
                if most > 0 and names not in shown:
                    most -= 1
                    shown.append(names)
                    yield trace


def relation_of(first_forbids: object, second_forbids: object) -> RuleRelation:
    """The relation of two rules, from a trace that only one of them forbids each, or None."""
    if first_forbids is None:
        return "equal" if second_forbids is None else "laxer"
    return "stricter" if second_forbids is None else "incomparable"


def common_types(
    first: Sequence[Variable], second: Sequence[Variable], vocabulary: Vocabulary
) -> tuple[str, ...] | None:
    """The object types common to both rules, in the order of the first's variables.

    None if both have the same types, or another number of variables; empty if no object is of the
    types of both.
    """
    types = [variable.type for variable in first]
    second_types = [variable.type for variable in second]
    if len(types) != len(second_types) or sorted(types) == sorted(second_types):
        return None
    for order in permutations(second_types):
        narrow = tuple(
            a if vocabulary.is_subtype(a, b) else b if vocabulary.is_subtype(b, a) else ""
            for a, b in zip(types, order, strict=True)
        )
        if all(narrow):
            return narrow
    return ()


def _narrowed(
    analyzed: AnalyzedRule, common: tuple[str, ...], vocabulary: Vocabulary
) -> AnalyzedRule:
    """The rule restricted to objects of these types."""
    is_subtype = vocabulary.is_subtype
    for order in permutations(common):
        pairs = list(zip(order, analyzed.rule.variables, strict=True))
        if all(is_subtype(kind, variable.type) for kind, variable in pairs):
            own = tuple(Variable(variable.name, kind) for kind, variable in pairs)
            return replace(analyzed, rule=replace(analyzed.rule, variables=own))
    raise AssertionError("the common types are those of both rules")


def diverse_witnesses(
    contest: Contest, first: Trace, most: int, apart_from: frozenset[str] = frozenset()
) -> tuple[Trace, ...]:
    """Up to ``most`` traces that only one rule forbids, each for a different reason.

    ``first`` is one of them and the first of the result. Some names are no reason ``apart_from``
    others.
    """
    traces = [first]
    shown = [_reasons(contest, first)]
    waiting = deque(frozenset([name]) for name in sorted(shown[0] - apart_from))
    tried: set[frozenset[str]] = set()
    hopeless: list[frozenset[str]] = []
    while waiting and len(traces) < most and len(tried) < MOST_SEARCHES:
        defaulted = waiting.popleft()
        if defaulted in tried:
            continue
        known = next((names for names in shown if not names & defaulted), None)
        if known is None:
            tried.add(defaulted)
            if any(names <= defaulted for names in hopeless):
                continue  # a smaller set was already impossible
            try:
                trace = contest.trace_as_usual(defaulted)
            except UndecidedError:
                continue
            if trace is None:
                hopeless.append(defaulted)
                continue
            known = _reasons(contest, trace)
            traces.append(trace)
            shown.append(known)
        waiting.extend(defaulted | {name} for name in sorted(known - apart_from))
    return tuple(traces)


def _reasons(contest: Contest, trace: Trace) -> frozenset[str]:
    return contest.names & non_default_names(trace, contest.forbidding.rulebook.vocabulary)


def non_default_names(trace: Trace, vocabulary: Vocabulary) -> frozenset[str]:
    """The declarations whose value in some state differs from their default."""
    names = frozenset[str]().union(*trace.states)
    return frozenset(
        name
        for (name, items), declaration in subjects_of(vocabulary, trace.objects, names)
        if declaration.default is not None
        if any(
            value_in(state, name, items, declaration) != declaration.default
            for state in trace.states
        )
    )
