"""Facts: what a vocabulary knows of every state, whatever the rules say."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.diagnostics import Diagnostic, Label
from rulec.rulebook.declared import Declared
from rulec.rulebook.meaning import truth
from rulec.rulebook.model import Fact, Variable
from rulec.rulebook.provisions import Provisions
from rulec.rulebook.scope import BoundVariable, Scope
from rulec.rulebook.uses import atoms_in
from rulec.syntax import tree


def fact_of(
    item: tree.FactItem, declared: Declared, provisions: Provisions
) -> tuple[Fact | None, list[Diagnostic]]:
    """The fact as meant (None if it has a mistake), and what is wrong with it.

    Its variables are not declared: they are of the types that what it says of them is about.
    """
    mistakes: list[Diagnostic] = []
    formula = item.formula
    if isinstance(formula, tree.Prefix) and formula.operator == "always" and not formula.bound:
        # Facts hold always; one may say so.
        formula = formula.operand
    variables = _variables(formula, declared, mistakes)
    scope = Scope(declared, provisions, variables, mistakes, counted=frozenset(("",)))
    provisions.expansions = 0
    found = truth(formula, scope)
    if found is None or mistakes:
        return None, mistakes
    typed = tuple(Variable(name, one.type) for name, one in variables.items() if one.type)
    return Fact(typed, found, item.span), mistakes


def _variables(
    formula: tree.Formula, declared: Declared, mistakes: list[Diagnostic]
) -> dict[str, BoundVariable]:
    found: dict[str, BoundVariable] = {}
    for name, wanted in _asked_for(formula, declared):
        known = found.get(name.text)
        if known is None or known.type is None or declared.fits(wanted, known.type):
            found[name.text] = BoundVariable(wanted, name.span, name.text)
        elif not declared.fits(known.type, wanted):
            mistakes.append(_two_types(name, known, wanted))
    return found


def _asked_for(formula: tree.Formula, declared: Declared) -> Iterator[tuple[tree.Name, str]]:
    """Every object that the formula speaks of, with the type that is needed there."""
    for use in atoms_in(formula):
        item = declared.items.get(use.name.text) or declared.value_of.get(use.name.text)
        if item is not None and len(item.parameters) == len(use.arguments):
            yield from zip(use.arguments, item.parameters, strict=True)


def _two_types(name: tree.Name, known: BoundVariable, wanted: str) -> Diagnostic:
    return Diagnostic(
        "R0302",
        f"`{name.text}` cannot be both a `{known.type}` and a `{wanted}`",
        name.span.place,
        expected=f"here it has to be a `{wanted}`",
        help="say the fact of objects of one type",
        labels=(Label(known.span.place, f"here it has to be a `{known.type}`"),),
    )
