"""What a witness is spared although no definition excludes it: nobody would believe it.

The rulebook ``believable`` beside the vocabulary ``road`` says it: its facts of each state, its
hard rules of states that follow each other, and its soft rules what is only a wish.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from fractions import Fraction
from functools import cache
from itertools import chain
from typing import NamedTuple

from rulec.analysis.shared_compilation import AnalyzedRule, compile_shared
from rulec.analysis.stated_axioms import said_within
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead
from rulec.logic.formula import QuantityTerm, Unary
from rulec.logic.free_names import names_in
from rulec.resources import rulebooks_folder
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook
from rulec.vocabulary import Quantity, Vocabulary
from rulec.witnesses.object_universe import Itself

MOST_KMH = 250
"""A speed that a witness does not exceed if one as short does without."""

LEAST_SIGN_KMH = 5
"""The lowest speed limit that a witness has, likewise."""


class Belief(NamedTuple):
    """What is believed of each state, of what follows what, and what is wished of each state."""

    facts: tuple[Axiom, ...]
    rules: tuple[AnalyzedRule, ...]
    wishes: tuple[Axiom, ...]


def believed(names: Set[str], vocabulary: Vocabulary) -> Belief:
    """What is believed of traces in these words of a vocabulary, if it has them from `road`."""
    book, compiled = _book()
    declared = book.vocabulary.declarations
    known = {name for name in names if vocabulary.declarations[name] == declared.get(name)}
    facts = tuple(axiom for axiom in book.axioms if known.issuperset(names_in(axiom.formula)))
    rules = [rule for rule in book.rules if known.issuperset(names_in(rule.formula))]
    return Belief(
        facts,
        tuple(compiled[rule.name] for rule in rules if rule.strength == "hard"),
        tuple(
            Axiom(rule.variables, rule.formula.operand)
            for rule in rules
            if rule.strength == "soft" and isinstance(rule.formula, Unary)
        ),
    )


def plausible_states(rules: Sequence[CompiledRule], vocabulary: Vocabulary) -> tuple[Axiom, ...]:
    """What is believed of states in the words that rules read, and of their numbers."""
    names = frozenset[str]().union(*map(declarations_read, rules))
    return (*believed(names, vocabulary).facts, *plausible_numbers(rules, vocabulary))


def plausible_numbers(rules: Sequence[CompiledRule], vocabulary: Vocabulary) -> tuple[Axiom, ...]:
    """That there are no numbers that no rule or default suggests.

    These are negative numbers, except of quantities with a negative default or that a rule compares
    with zero or less, distances below 1 m, unless a rule sets such a limit, and speeds beyond
    ``MOST_KMH``, unless that is a default.
    """
    limits, axioms = limits_of(rules), []
    for name in sorted(frozenset[str]().union(*map(declarations_read, rules))):
        item = vocabulary.declarations[name]
        if isinstance(item, Quantity):
            own, usual, least = Itself(item), item.default or 0, min(limits.get(name) or (2,))
            if usual >= 0 < least:
                far = item.unit == "m" and usual > 0 and least > 1
                axioms.append(said_within(name, own, ">=", Fraction(far)))
            # A limit that is beyond all speeds by default, where no sign shows one, is on a sign.
            if item.unit == "km/h" and usual <= MOST_KMH:
                axioms.append(said_within(name, own, "<=", Fraction(MOST_KMH)))
            elif item.unit == "km/h":
                axioms.append(said_within(name, own, ">=", Fraction(LEAST_SIGN_KMH)))
    return tuple(axioms)


def limits_of(rules: Iterable[CompiledRule]) -> dict[str, set[Fraction]]:
    """The limits with which rules compare quantities on their own, by name."""
    limits: dict[str, set[Fraction]] = {}
    for read in chain.from_iterable(rule.machine.reads for rule in rules):
        if isinstance(read, NumberRead) and len(read.terms) == 1:
            ((factor, term),) = read.terms
            if isinstance(term, QuantityTerm):
                own = limits.setdefault(term.name, set())
                own.update(threshold.limit / factor for threshold in read.thresholds)
    return limits


def declarations_read(rule: CompiledRule) -> frozenset[str]:
    """The names of the declarations that a rule reads."""
    names: set[str] = set()
    for read in rule.machine.reads:
        if isinstance(read, NumberRead):
            names.update(name for _, term in read.terms for name in names_in(term))
        else:
            names.add(read.name)
    return frozenset(names)


@cache
def _book() -> tuple[Rulebook, Mapping[str, AnalyzedRule]]:
    book = load_rulebook(rulebooks_folder() / "vocabulary" / "believable.rules")
    rules: Mapping[str, Rule] = {rule.name: rule for rule in book.rules}
    return book, compile_shared([book], [rules])[0]
