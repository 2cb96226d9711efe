"""Checks of parameters and definitions, independent of their uses."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.diagnostics import Diagnostic
from rulec.rulebook.elaborate.elaboration import elaborate, number
from rulec.rulebook.elaborate.macro_expansion import parameter_value
from rulec.rulebook.elaborate.scope import AnyArgument, Call, Scope, bound_variables
from rulec.rulebook.elaborate.time_reach import operator_warnings
from rulec.rulebook.names.declaration_messages import twice, unknown_dimension
from rulec.rulebook.names.referenced_names import names_used
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.syntax import tree
from rulec.vocabulary.dimensions import DIMENSIONS


def check_constants_and_macros(
    symbols: SymbolTable, constants: ConstantsAndMacros
) -> list[Diagnostic]:
    """Mistakes in parameters and definitions; broken ones are recorded in ``constants``.

    Each is checked after those that it uses, so that a mistake is first found where it was made.
    """
    mistakes: list[Diagnostic] = []
    for name in _in_order_of_use(constants):
        if name in constants.overlay.parameters:
            mistakes += _check_parameter(name, symbols, constants)
        elif name not in constants.broken:
            mistakes += _check_definition(constants.overlay.definitions[name], symbols, constants)
    return mistakes


def _in_order_of_use(constants: ConstantsAndMacros) -> list[str]:
    uses: dict[str, list[str]] = {}
    for name, values in constants.overlay.parameters.items():
        uses[name] = [used for value in values for used in names_used(value.item)]
    for name, definition in constants.overlay.definitions.items():
        uses[name] = [*names_used(definition)]
    ordered: dict[str, None] = {}
    seen: set[str] = set()
    pending = [*reversed(uses)]
    while pending:
        name = pending[-1]
        further = [] if name in seen else [used for used in uses[name] if used in uses]
        seen.add(name)
        pending += (used for used in reversed(further) if used not in seen)
        if pending[-1] == name:
            ordered.setdefault(pending.pop())
    return [*ordered]


def _check_parameter(
    name: str, symbols: SymbolTable, constants: ConstantsAndMacros
) -> Iterator[Diagnostic]:
    values = constants.overlay.parameters[name]
    for value in values:
        kind = value.item.dimension if isinstance(value.item, tree.ParamItem) else None
        if kind is not None and kind.text not in DIMENSIONS:
            yield unknown_dimension(kind, list(DIMENSIONS))
    if any(in_force(value.item.in_force, constants.at) for value in values):
        first = values[0].item.name
        scope = Scope(symbols, constants, {}, [])
        with scope.within_limits("parameter", first):
            parameter_value(tree.AtomUse(first, span=first.span), scope, number)
        yield from scope.mistakes
        if scope.mistakes:
            constants.numbers[name] = None


def _check_definition(
    item: tree.DefineItem, symbols: SymbolTable, constants: ConstantsAndMacros
) -> list[Diagnostic]:
    mistakes: list[Diagnostic] = []
    typed = [parameter for parameter in item.parameters if parameter.type is not None]
    variables = bound_variables(typed, symbols, mistakes.append)
    first: dict[str, tree.Parameter] = {}
    for parameter in item.parameters:
        name = parameter.name
        known = first.setdefault(name.text, parameter)
        # Two with types have been found already.
        if known is not parameter and (known.type is None or parameter.type is None):
            mistakes.append(twice("parameter", name, known.span))
    untyped = [parameter.name.text for parameter in item.parameters if parameter.type is None]
    scope = Scope(
        symbols,
        constants,
        variables,
        mistakes,
        relations=dict.fromkeys(untyped, AnyArgument()),
        calls=(Call(item.name.text, None),),
        taken=frozenset(first),
        owner="definition",
    )
    meaning = None
    with scope.within_limits("definition", item.name):
        meaning = elaborate(item.body, scope)
    wrong = any(mistake.severity == "error" for mistake in mistakes)
    if wrong or not constants.broken.isdisjoint(names_used(item)):
        constants.broken.add(item.name.text)
    elif meaning is not None:
        mistakes += scope.unused(item.parameters, item)
        mistakes += operator_warnings(item.body, constants.overlay)
    return mistakes
