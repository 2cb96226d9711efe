"""Reads of a rule that may have to do with each other, by what is known of its own objects.

Most rules count at most what is true of the objects that they are bound to, as `some other: car
(other = x and parked(other))` does. What such reads may be together depends on no one else, so that
it is looked up by what a state says, whatever the objects are called.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.logic.kleene import Between, Unknown, holds
from rulec.monitoring.uncertainty.state_letters.completions import Subject, joint_digits
from rulec.monitoring.uncertainty.state_letters.entanglement import (
    Entanglement,
    NothingKnown,
    count_in,
    counts,
    deciding_subjects,
    entanglement,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import (
    Letters,
    names_of_read,
    read_digits,
)
from rulec.trace import Value
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue

MOST_KNOWN = 1 << 14
"""Values whose letters are kept before all are forgotten."""


@dataclass(frozen=True, slots=True)
class _LocalState:
    """What a state says of a rule's variables, as a ``StateView`` would."""

    values: Mapping[Subject, PartialValue | None]
    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def given(self, name: str, items: tuple[str, ...]) -> PartialValue | None:
        """The value, be it partial, or the declared default."""
        return self.values.get((name, items))

    def value(self, name: str, items: tuple[str, ...]) -> Value | Unknown:
        """The value if it is known."""
        value = self.values.get((name, items))
        if value is None or value is UNKNOWN or isinstance(value, Interval):
            return Unknown(name, items)
        return value

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The quantity's value: exact, or its bounds."""
        value = self.values.get((name, items))
        if isinstance(value, Interval):
            return Between(name, items, exact(value.low), exact(value.high))
        known = self.value(name, items)
        assert not isinstance(known, str), "it is a quantity"
        return known if isinstance(known, Unknown) else exact(known)


class EntangledReads:
    """Reads that count, or that share values, of a rule that depends on its own objects alone.

    ``numbers`` are their places among the rule's reads, ``subjects`` what they depend on, asked of
    variables, ``others`` the places of reads that are independent of all others. ``found`` has what
    these reads may be together, as cubes of their digits, and whether no more is said than is;
    ``number`` finds its place by the values of the ``subjects``.
    """

    def __init__(self, rule: CompiledRule, vocabulary: Vocabulary) -> None:
        reads = rule.machine.reads
        self._objects = {variable.name: variable.type for variable in rule.variables}
        self._vocabulary = vocabulary
        self._binding = {name: name for name in self._objects}
        everybody = NothingKnown(self._objects, vocabulary)
        about = [set(deciding_subjects(read, self._binding, everybody)) for read in reads]
        places = Counter(subject for own in about for subject in own)
        self.numbers = tuple(
            [
                n
                for n, read in enumerate(reads)
                if count_in(read) or any(places[subject] > 1 for subject in about[n])
            ]
        )
        self.others = tuple([n for n in range(len(reads)) if n not in self.numbers])
        self._reads = [reads[n] for n in self.numbers]
        self.subjects = tuple(sorted(set[Subject]().union(*[about[n] for n in self.numbers])))
        self._about: Entanglement = entanglement(self._reads, self._binding, (), everybody)
        self.found: list[tuple[Letters, bool]] = []
        self._numbers: dict[tuple[Letters, bool], int] = {}
        self._known: dict[tuple[PartialValue | None, ...], int] = {}

    def number(self, values: tuple[PartialValue | None, ...]) -> int:
        """The place of what reads may be for these values. Raises MissingValueError."""
        known = self._known.get(values)
        if known is None:
            found = self._letters(values)
            known = self._numbers.setdefault(found, len(self.found))
            if known == len(self.found):
                self.found.append(found)
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            self._known[values] = known
        return known

    def _letters(self, values: Sequence[PartialValue | None]) -> tuple[Letters, bool]:
        given = dict(zip(self.subjects, values, strict=True))
        state = _LocalState(given, self._objects, self._vocabulary)
        digits = [read_digits(read).in_state(self._binding, state) for read in self._reads]
        if all(own & (own - 1) == 0 for own in digits) or not self._about.is_met(state):
            return (tuple(digits),), True
        joint = joint_digits(self._reads, self._binding, state, ())
        letters = [tuple([1 << digit for digit in one]) for one in sorted(joint.digits)]
        return tuple(letters), joint.exact


def entangled_reads(
    rule: CompiledRule, axioms: Sequence[CompiledAxiom], vocabulary: Vocabulary
) -> EntangledReads | None:
    """The entangled reads of a rule; None if they depend on who else is there, or on facts."""
    names = {name for read in rule.machine.reads for name in names_of_read(read)}
    if any(not names.isdisjoint(names_in(axiom.formula)) for axiom in axioms):
        return None
    if not all(_is_local(read, rule, vocabulary) for read in rule.machine.reads):
        return None
    return EntangledReads(rule, vocabulary)


def _is_local(read: Read | NumberRead, rule: CompiledRule, vocabulary: Vocabulary) -> bool:
    """Whether a read depends on nobody but the objects that the rule is bound to."""
    count = count_in(read)
    if count is None:
        return True
    if any(map(counts, ltl.atoms_of(count.body))):
        return False
    variables = {variable.name: variable.type for variable in rule.variables}
    for kind in variables.values():
        both = ({kind, count.type} <= set(vocabulary.ancestors(own)) for own in vocabulary.types)
        # Else it is the type of the object that decides whether it counts.
        if not vocabulary.is_subtype(kind, count.type) and any(both):
            return False
    # No name of a variable has a blank.
    strangers = {f"some {kind}": kind for kind in vocabulary.types}
    everybody = NothingKnown({**variables, **strangers}, vocabulary)
    binding = {name: name for name in variables}
    assert isinstance(read, NumberRead)
    return len(read.terms) == 1 and not any(
        vocabulary.is_subtype(kind, count.type)
        and holds(count.body, {**binding, count.variable: item}, everybody) is not False
        for item, kind in strangers.items()
    )
