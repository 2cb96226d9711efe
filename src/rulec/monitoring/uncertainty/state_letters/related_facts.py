"""The axioms related to what a rule reads, and whether they reach beyond its own objects."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_of, reads_in
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    subjects_in,
)
from rulec.rulebook.rulebook_model import Variable
from rulec.rulebook.rules.axiom_instances import bound_to, counts
from rulec.valuations.connections import reached
from rulec.vocabulary import Vocabulary


class FactInstance(NamedTuple):
    """An axiom for the objects of an ``environment``."""

    formula: ltl.Formula
    environment: Mapping[str, str]

    def about(self, everybody: PartialView) -> frozenset[Subject]:
        """What it refers to."""
        return frozenset(subjects_in(self.formula, self.environment, everybody))


def instances_of(axioms: Iterable[CompiledAxiom], everybody: PartialView) -> Iterator[FactInstance]:
    """An instance of each axiom for each choice of its objects."""
    for axiom in axioms:
        for environment in bound_to(axiom.variables, everybody.objects, everybody.vocabulary):
            yield FactInstance(axiom.formula, environment)


def related_facts(
    names: Iterable[str], axioms: Sequence[CompiledAxiom]
) -> tuple[CompiledAxiom, ...]:
    """The axioms about some of these names, or about names in such axioms, and so on."""
    about = [names_of(axiom.formula) for axiom in axioms]
    return tuple([axioms[place] for place in reached(names, about)])


@lru_cache(maxsize=1 << 10)  # asked of each fact by each rule
def keeps_to_its_objects(fact: CompiledAxiom) -> bool:
    """Whether each value in an axiom is about all of its objects together.

    What such an axiom says of some objects then is independent of any others.
    """
    own = {variable.name for variable in fact.variables}
    return not counts(fact.formula) and all(
        own == set(arguments) for arguments in _arguments_in(fact.formula)
    )


def is_of_one(fact: CompiledAxiom) -> bool:
    """Whether an axiom is about the world alone, or about one object alone."""
    return len(fact.variables) < 2 and keeps_to_its_objects(fact)


def fits_or_not(fact: CompiledAxiom, variables: Sequence[Variable], vocabulary: Vocabulary) -> bool:
    """Whether the types of a rule's variables alone decide which objects an axiom is about.

    They do not if the axiom is about buses, say, and the rule about vehicles, which may be buses.
    """
    return all(
        vocabulary.is_subtype(own.type, wanted.type)
        or not vocabulary.is_subtype(wanted.type, own.type)
        for wanted in fact.variables
        for own in variables
    )


def _arguments_in(formula: ltl.Formula) -> Iterator[tuple[str, ...]]:
    for read in reads_in(formula):
        assert not isinstance(read, ltl.Count), "the fact counts nothing"
        yield read.arguments
