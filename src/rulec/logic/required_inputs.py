"""The inputs that determine a formula's value in a state."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from rulec.logic.formula import Atom, Comparison, Formula, QuantityTerm, Term, atoms_of
from rulec.logic.renaming import rename_variables


def required_inputs(
    formula: Formula, objects: Mapping[str, str], fits: Callable[[str, str], bool]
) -> Iterator[Atom | QuantityTerm]:
    """Every atom and quantity that a formula reads, with repetitions.

    Those of every object that may count are included.

    ``objects`` maps those that are there to their types; ``fits`` tells whether the first of two
    types is the second or one below it.
    """
    for atom in atoms_of(formula):
        if isinstance(atom, Comparison):
            for _, term in atom.terms:
                yield from _of_term(term, objects, fits)
        else:
            yield atom


def _of_term(
    term: Term, objects: Mapping[str, str], fits: Callable[[str, str], bool]
) -> Iterator[Atom | QuantityTerm]:
    if isinstance(term, QuantityTerm):
        yield term
        return
    for name, kind in objects.items():
        if fits(kind, term.type):
            # What is asked of the object that stands in the count's place.
            yield from required_inputs(
                rename_variables(term.body, {term.variable: name}), objects, fits
            )
