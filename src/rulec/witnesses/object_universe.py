"""Universe of objects for comparing rules, with its axioms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.logic.formula import Binary, Comparison, Count, Formula, Term, Unary, atoms_of
from rulec.logic.renaming import rename_variables
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.object_choices import choices


@dataclass(frozen=True, slots=True)
class ObjectUniverse:
    """Objects that are always present, their types, and the axioms on them.

    ``unsaid`` are declarations that traces leave out.
    """

    objects: Mapping[str, str]
    vocabulary: Vocabulary
    axioms: tuple[Axiom, ...] = ()
    unsaid: frozenset[str] = frozenset()

    def bindings(self, variables: Sequence[Variable]) -> list[dict[str, str]]:
        """Every way to bind variables to distinct objects of their types."""
        names = [variable.name for variable in variables]
        types = [variable.type for variable in variables]
        bound_objects = choices(types, self.objects, self.vocabulary)
        return [dict(zip(names, chosen, strict=True)) for chosen in bound_objects]

    def axiom_formulas(self) -> Iterator[Formula]:
        """The axioms, said of the objects."""
        for axiom in self.axioms:
            for names in self.bindings(axiom.variables):
                yield self.renamed(axiom.formula, names)

    def renamed(self, formula: Formula, names: Mapping[str, str]) -> Formula:
        """The formula of one state, with objects in the place of variables."""
        return rename_variables(self.canonical(formula), names)

    def canonical(self, formula: Formula) -> Formula:
        """Rename the variables of a formula's counts to canonical names."""
        match formula:
            case Comparison(terms, relation, limit, text):
                own = tuple((factor, self.canonical_term(term)) for factor, term in terms)
                return Comparison(own, relation, limit, text)
            case Unary(operator, operand, bound):
                return Unary(operator, self.canonical(operand), bound)
            case Binary(operator, left, right, bound):
                return Binary(operator, self.canonical(left), self.canonical(right), bound)
        return formula

    def canonical_term(self, term: Term) -> Term:
        """Rename a count's variable to ``COUNTED``, so that equal counts are equal."""
        if not isinstance(term, Count):
            return term
        body = self.canonical(term.body)
        # No object has such a name, and no count inside another one has the same.
        name = COUNTED * (1 + _depth(body))
        return Count(name, term.type, rename_variables(body, {term.variable: name}))


COUNTED = "?"
"""The variable of every count in a universe; that of one with counts inside is longer."""

EXTRA = "+"
"""An object that is there only to be counted, before it has a name."""


def _depth(formula: Formula) -> int:
    """Nesting depth of the counts in a formula."""
    return max((len(count.variable) for count in counts_in(formula)), default=0)


def counts_in(formula: Formula) -> Iterator[Count]:
    """The counts that a formula compares, not those inside of others."""
    for proposition in atoms_of(formula):
        if isinstance(proposition, Comparison):
            yield from (term for _, term in proposition.terms if isinstance(term, Count))
