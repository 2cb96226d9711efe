"""The declarations that the rules of a rulebook speak of."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.logic.formula import Atom, Comparison, Count, Formula, atoms_of
from rulec.rulebook.rulebook_model import Rulebook


def used_declarations(rulebook: Rulebook) -> frozenset[str]:
    """The enumerations, signals and quantities that the formula of some rule mentions."""
    return frozenset(name for rule in rulebook.rules for name in declared_names_in(rule.formula))


def declared_names_in(formula: Formula) -> Iterator[str]:
    """The names of declarations in a formula, in their order, with repetitions."""
    for atom in atoms_of(formula):
        match atom:
            case Atom(name):
                yield name
            case Comparison(terms):
                for _, term in terms:
                    yield from (
                        declared_names_in(term.body) if isinstance(term, Count) else (term.name,)
                    )
