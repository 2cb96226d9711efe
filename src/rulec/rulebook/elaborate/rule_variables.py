"""The variables of a rule or a definition."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.rulebook.elaborate.scope import BoundVariable
from rulec.rulebook.names.declaration_messages import twice, unknown_type
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.syntax import tree


def variables_of(
    parameters: tuple[tree.Parameter, ...], symbols: SymbolTable, mistakes: list[Diagnostic]
) -> dict[str, BoundVariable]:
    """Variables with their types; mistakes are added to ``mistakes``."""
    bound_variables: dict[str, BoundVariable] = {}
    for parameter in parameters:
        name, type_ = parameter.name, parameter.type
        assert type_ is not None, "the grammar asks for a variable's type"
        known = type_.text in symbols.types
        if not known and not symbols.may_know_type(type_.text):
            mistakes.append(unknown_type(type_, list(symbols.types)))
        if name.text in bound_variables:
            mistakes.append(twice("variable", name, bound_variables[name.text].span))
        else:
            bound_variables[name.text] = BoundVariable(
                type_.text if known else None, parameter.span, name.text
            )
    return bound_variables
