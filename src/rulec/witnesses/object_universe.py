"""A universe of objects for comparing rules, with its axioms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from rulec.logic import formula as ltl
from rulec.logic.formula import with_terms
from rulec.logic.free_names import reads_in, rename_variables
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.rulebook.rules.axiom_instances import bound_to
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices

COUNTED = "?"
"""The variable of every count in a universe; repeated if the count contains counts."""

EXTRA = "+"
"""The name of an object that exists only to be counted, before it is given a name."""


T = TypeVar("T")


@dataclass(frozen=True, eq=False, slots=True)
class Itself(Generic[T]):
    """A key compared by identity, because comparing equal objects would take long."""

    item: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Itself) and other.item is self.item

    def __hash__(self) -> int:
        return id(self.item)


@dataclass(frozen=True, slots=True)
class ObjectUniverse:
    """Objects that are always present, their types, and the axioms about them.

    ``unsaid`` are declarations that traces leave out.
    """

    objects: Mapping[str, str]
    vocabulary: Vocabulary
    axioms: tuple[Axiom, ...] = ()
    unsaid: frozenset[str] = frozenset()

    def bindings(self, variables: Sequence[Variable]) -> list[dict[str, str]]:
        """Every way to bind variables to distinct objects of their types."""
        return list(bound_to(variables, self.objects, self.vocabulary))

    def axiom_bindings(self) -> Iterator[tuple[Axiom, dict[str, str]]]:
        """Each axiom with each way to bind its variables."""
        of_types: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
        for axiom in self.axioms:
            types = tuple([variable.type for variable in axiom.variables])
            if types not in of_types:
                of_types[types] = list(choices(types, self.objects, self.vocabulary))
            names = [variable.name for variable in axiom.variables]
            for chosen in of_types[types]:
                yield axiom, dict(zip(names, chosen, strict=True))


def applied_to(axiom: Axiom, names: Mapping[str, str]) -> ltl.Formula:
    """An axiom's formula with objects for its variables."""
    return rename_variables(_canonical(axiom.formula), names)


def _canonical(formula: ltl.Formula) -> ltl.Formula:
    if isinstance(formula, ltl.Unary | ltl.Binary):
        return ltl.with_operands(formula, _canonical)
    if isinstance(formula, ltl.Comparison):
        return with_terms(formula, canonical_term)
    return formula


def canonical_term(term: ltl.Term) -> ltl.Term:
    """Rename a count's variable to ``COUNTED``, so that equal counts are equal."""
    if not isinstance(term, ltl.Count):
        return term
    body = _canonical(term.body)
    # Objects never have such names, and nested counts get names of different lengths.
    name = COUNTED * (1 + max((len(count.variable) for count in counts_in(body)), default=0))
    return ltl.Count(name, term.type, rename_variables(body, {term.variable: name}))


def counts_in(formula: ltl.Formula) -> Iterator[ltl.Count]:
    """The counts that a formula compares, without those inside other counts."""
    yield from (read for read in reads_in(formula) if isinstance(read, ltl.Count))
