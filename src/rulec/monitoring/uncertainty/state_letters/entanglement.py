"""Values that, if they are unknown, bear on more than one thing that a rule reads."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import ceil

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.logic.kleene import Unknown, holds
from rulec.monitoring.uncertainty.state_letters.completions import (
    PartialView,
    Subject,
    subjects_in,
    subjects_of_read,
)
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval


@dataclass(frozen=True, slots=True)
class NothingKnown:
    """A state of which only is known who is there."""

    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def value(self, name: str, items: tuple[str, ...]) -> bool | float | str | Unknown:
        """Not known."""
        return Unknown(name, items)

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """Not known."""
        return Unknown(name, items)

    def given(self, name: str, items: tuple[str, ...]) -> None:
        """Not known."""


@dataclass(frozen=True, slots=True)
class Entanglement:
    """What of a rule's reads, asked of some objects, is not independent if it is unknown.

    A value is ``entangled`` that is read in several places, or of which an axiom speaks. Where none
    of these is unknown, nor a ``counted`` one an interval, each read may have any of its digits
    whatever the others have; a count any number from those that count to those that may.
    """

    entangled: frozenset[Subject]
    counted: frozenset[Subject]

    def is_met(self, view: PartialView) -> bool:
        """Whether unknown values of a state have to do with each other, or one may be missing."""
        there = view.objects.keys()
        return any(type(view.given(*x)) in UNKNOWN_TYPES for x in self.entangled) or any(
            type(view.given(*x)) in _NOT_COUNTED and there >= set(x[1]) for x in self.counted
        )


_NOT_COUNTED = frozenset({Interval, type(None)})


def entanglement(
    reads: Sequence[Read | NumberRead],
    binding: Mapping[str, str],
    axioms: Sequence[CompiledAxiom],
    everybody: NothingKnown,
) -> Entanglement:
    """What is entangled for all objects that may be there."""
    places: Counter[Subject] = Counter()
    counted: set[Subject] = set()
    entangled: set[Subject] = set()
    for read in reads:
        count = count_in(read)
        own = list(deciding_subjects(read, binding, everybody))
        if count is None:
            places.update(own)
            continue
        assert isinstance(read, NumberRead)
        if len(read.terms) > 1 or _skips(read) or any(map(counts, ltl.atoms_of(count.body))):
            own = [*subjects_of_read(read, binding, everybody)]
            entangled.update(own)
        counted.update(own)
        places.update(own)
    in_axioms = {name for axiom in axioms for name in names_in(axiom.formula)}
    entangled |= {one for one, n in places.items() if n > 1 or one[0] in in_axioms}
    return Entanglement(frozenset(entangled), frozenset(counted))


def count_in(read: Read | NumberRead) -> ltl.Count | None:
    """The first term of a read that counts, if any."""
    terms = read.terms if isinstance(read, NumberRead) else ()
    return next((term for _, term in terms if isinstance(term, ltl.Count)), None)


def counts(part: ltl.Proposition) -> bool:
    """Whether a part of a formula compares how many count."""
    return isinstance(part, ltl.Comparison) and any(
        isinstance(term, ltl.Count) for _, term in part.terms
    )


def deciding_subjects(
    read: Read | NumberRead, binding: Mapping[str, str], everybody: NothingKnown
) -> Iterator[Subject]:
    """What decides a read, with repetitions; of a count what decides whether objects count."""
    count = count_in(read)
    if count is None:
        yield from subjects_of_read(read, binding, everybody)
        return
    vocabulary = everybody.vocabulary
    for item, kind in everybody.objects.items():
        inner = {**binding, count.variable: item}
        if vocabulary.is_subtype(kind, count.type) and isinstance(
            holds(count.body, inner, everybody), Unknown
        ):
            yield from subjects_in(count.body, inner, everybody)


def _skips(read: NumberRead) -> bool:
    """Whether one object more may pass two thresholds of a count."""
    most = max([0, *(ceil(threshold.limit) for threshold in read.thresholds)])
    digits = [read.digit(Fraction(n)) for n in range(most + 2)]
    return any(after > before + 1 for before, after in pairwise(digits))
