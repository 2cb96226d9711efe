"""The axioms that matter to what is read: its cone of influence.

All others hold if everything that they are about has its default, and share nothing with what is
read; so in any state their part can have its defaults, and they decide nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

from rulec.automata.mealy_monitor import Read
from rulec.logic.formula import Formula, QuantityTerm
from rulec.logic.free_names import variables_of
from rulec.rulebook.rulebook_model import Axiom
from rulec.valuations.connections import reached
from rulec.vocabulary import Vocabulary
from rulec.witnesses.letter_functions import LetterFunction, Reads, axiom_function
from rulec.witnesses.object_universe import EXTRA, Itself, ObjectUniverse, applied_to, counts_in
from rulec.witnesses.state_synthesis import Subject, default_digit

MOST_KEPT = 20_000
"""The most ground axioms that are kept for later questions about the same objects."""


@dataclass(frozen=True, eq=False)
class GroundAxiom:
    """An axiom with objects for its variables: its formula, and cached properties."""

    formula: Formula
    vocabulary: Vocabulary

    @cached_property
    def function(self) -> LetterFunction:
        """The axiom's letter function. Raises UndecidedError."""
        return axiom_function(self.formula, self.vocabulary)

    @cached_property
    def is_counting(self) -> bool:
        """Whether the axiom compares a count."""
        return any(True for _ in counts_in(self.formula))

    @cached_property
    def objects(self) -> frozenset[str]:
        """The objects that the axiom is about."""
        return frozenset(variables_of(self.formula))

    @cached_property
    def subjects(self) -> frozenset[Subject]:
        """The subjects that the axiom reads, without those that its counts read."""
        return subjects_read(self.function.reads)

    @cached_property
    def holds_by_default(self) -> bool:
        """Whether the axiom holds if everything that it reads has its default."""
        return _holds_by_default(self.function, self.vocabulary)


def ground_axioms(universe: ObjectUniverse) -> Iterator[GroundAxiom]:
    """The axioms for the universe's objects; cached for each vocabulary."""
    known = _known_instances(Itself(universe.vocabulary))
    if len(known) > MOST_KEPT:
        known.clear()
    for axiom, names in universe.axiom_bindings():
        key = id(axiom), *names.values()
        if key not in known:
            # Keeping the axiom alive ensures that its id is not reused.
            known[key] = axiom, GroundAxiom(applied_to(axiom, names), universe.vocabulary)
        yield known[key][1]


def axioms_about(kind: str, universe: ObjectUniverse) -> tuple[GroundAxiom, ...]:
    """The axioms without counts about one more object besides the universe's."""
    known = _about(Itself(universe.vocabulary))
    key = kind, tuple(universe.objects.items()), tuple(map(id, universe.axioms))
    if key not in known:
        if len(known) > MOST_KEPT:
            known.clear()
        with_it = replace(universe, objects={**universe.objects, EXTRA: kind})
        instances = tuple(
            [
                axiom
                for axiom in ground_axioms(with_it)
                if not axiom.is_counting and EXTRA in axiom.objects
            ]
        )
        known[key] = universe.axioms, instances
    return known[key][1]


@lru_cache(maxsize=8)
def _about(
    _: Itself[Vocabulary],
) -> dict[tuple[object, ...], tuple[Sequence[Axiom], tuple[GroundAxiom, ...]]]:
    return {}


@lru_cache(maxsize=8)
def _known_instances(_: Itself[Vocabulary]) -> dict[tuple[object, ...], tuple[Axiom, GroundAxiom]]:
    return {}


def relevant_axioms(axioms: Sequence[GroundAxiom], read: Iterable[Reads]) -> list[GroundAxiom]:
    """The axioms, in their order, connected with what is read, directly or through others.

    Axioms that defaults violate, and those that count objects, are included. Raises UndecidedError.
    """
    always = {
        place
        for place, axiom in enumerate(axioms)
        if axiom.is_counting or not axiom.holds_by_default
    }
    start = {subject for reads in read for subject in subjects_read(reads)}
    start = start.union(*[axioms[place].subjects for place in always])
    about = [axiom.subjects for axiom in axioms]
    return [axioms[place] for place in sorted(always.union(reached(start, about)))]


def subjects_read(reads: Reads) -> frozenset[Subject]:
    """The subjects of reads, without those that their counts read."""
    subjects: set[Subject] = set()
    for read in reads:
        if isinstance(read, Read):
            subjects.add((read.name, read.variables))
        else:
            terms = (term for _, term in read.terms)
            subjects |= {(t.name, t.arguments) for t in terms if isinstance(t, QuantityTerm)}
    return frozenset(subjects)


def hold_by_default(functions: Iterable[LetterFunction], vocabulary: Vocabulary) -> bool:
    """Whether every function without counts is 1 if everything that it reads has its default."""
    return all(_holds_by_default(function, vocabulary) for function in functions)


def _holds_by_default(axiom: LetterFunction, vocabulary: Vocabulary) -> bool:
    digits = [default_digit(read, vocabulary) for read in axiom.reads]
    known = [digit for digit in digits if digit is not None]
    return len(known) == len(digits) and bool(axiom.value(known))
