"""Facts: what a vocabulary knows of every state, whatever the rules say."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rulec.diagnostics import Diagnostic
from rulec.rulebook.elaborate.elaboration import truth
from rulec.rulebook.elaborate.scope import SIDES, BoundVariable, Scope
from rulec.rulebook.names.atom_messages import two_types
from rulec.rulebook.names.referenced_names import parts_of
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.syntax import tree


def axiom_of(
    item: tree.FactItem, symbols: SymbolTable, constants: ConstantsAndMacros
) -> tuple[Axiom | None, list[Diagnostic]]:
    """Elaborate a fact; return its axiom or None, and its mistakes.

    Its variables are not declared: they are of the types that what it says of them is about.
    """
    mistakes: list[Diagnostic] = []
    formula = item.formula
    if isinstance(formula, tree.Prefix) and formula.operator == "always" and not formula.bound:
        # Facts hold always; one may say so.
        formula = formula.operand
    variables = _variables(_asked_for(formula, symbols, constants), symbols, mistakes)
    scope = Scope(
        symbols, constants, variables, mistakes, in_moment=True, taken=frozenset(variables)
    )
    constants.begin()
    result = truth(formula, scope)
    if result is None or mistakes:
        return None, mistakes
    typed = tuple(
        Variable(name, variable.type) for name, variable in variables.items() if variable.type
    )
    return Axiom(typed, result, item.span), mistakes


def _variables(
    asked_for: Iterable[tuple[tree.Name, str]], symbols: SymbolTable, mistakes: list[Diagnostic]
) -> dict[str, BoundVariable]:
    bound_variables: dict[str, BoundVariable] = {}
    for name, wanted in asked_for:
        known = bound_variables.get(name.text)
        if known is None or known.type is None or symbols.fits(wanted, known.type):
            bound_variables[name.text] = BoundVariable(wanted, name.span, name.text)
        elif not symbols.fits(known.type, wanted):
            mistakes.append(two_types(name, wanted, known.type, known.span))
    return bound_variables


def _asked_for(
    formula: tree.Formula,
    symbols: SymbolTable,
    constants: ConstantsAndMacros,
    counted: frozenset[str] = frozenset(),
) -> Iterator[tuple[tree.Name, str]]:
    """Every object in a formula, with the type required of it.

    ``counted`` are the variables of the counts around it, which are no objects of the fact's.
    """
    if isinstance(formula, tree.AtomUse):
        wanted = _parameters(formula, symbols, constants)
        if len(wanted) == len(formula.arguments):
            for name, kind in zip(formula.arguments, wanted, strict=True):
                if kind is not None and name.text not in counted:
                    yield name, kind
    elif isinstance(formula, tree.Aggregate):
        counted |= {formula.variable.name.text}
    for part in parts_of(formula):
        yield from _asked_for(part, symbols, constants, counted)


def _parameters(
    use: tree.AtomUse, symbols: SymbolTable, constants: ConstantsAndMacros
) -> Sequence[str | None]:
    """Parameter types of a name; None where any argument will do."""
    name = use.name.text
    definition = constants.definitions.get(name)
    if definition is not None:
        kinds = [
            parameter.type.text if parameter.type else None for parameter in definition.parameters
        ]
        return [kind if kind in symbols.types else None for kind in kinds]
    item = symbols.items.get(name) or symbols.value_of.get(
        SIDES[name]["right"] if name in SIDES else name
    )
    return () if item is None else item.parameters
