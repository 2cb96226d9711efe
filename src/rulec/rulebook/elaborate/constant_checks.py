"""Checks of parameters and definitions, independent of their uses."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.diagnostics import Diagnostic
from rulec.rulebook.arithmetic.size_limits import TooDeepError, TooLargeError
from rulec.rulebook.elaborate import rule_messages
from rulec.rulebook.elaborate.elaboration import elaborate, number
from rulec.rulebook.elaborate.parameter_values import parameter
from rulec.rulebook.elaborate.rule_variables import variables_of
from rulec.rulebook.elaborate.scope import AnyArgument, Call, Scope
from rulec.rulebook.names.declaration_messages import twice, unknown_dimension
from rulec.rulebook.names.referenced_names import names_used
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros, in_force
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS


def check_constants_and_macros(
    symbols: SymbolTable, constants: ConstantsAndMacros
) -> list[Diagnostic]:
    """Mistakes in parameters and definitions; the broken ones are noted in ``constants``.

    Each comes after those that it uses, so that a mistake is met first where it was made.
    """
    mistakes: list[Diagnostic] = []
    for name in _in_order_of_use(constants):
        constants.begin()
        if name in constants.overlay.parameters:
            mistakes += _check_parameter(name, symbols, constants)
        elif name not in constants.broken:
            mistakes += _check_definition(constants.definitions[name], symbols, constants)
    return mistakes


def _in_order_of_use(constants: ConstantsAndMacros) -> list[str]:
    """Parameters and definitions, each after those it uses, circles aside."""
    uses: dict[str, list[str]] = {}
    for name, values in constants.overlay.parameters.items():
        uses[name] = [one for value in values for one in names_used(value.item)]
    for name, definition in constants.definitions.items():
        uses[name] = [*names_used(definition)]
    ordered: list[str] = []
    seen: set[str] = set()
    for name in uses:
        way = [(name, iter(uses[name]))] if name not in seen else []
        seen.add(name)
        while way:
            here, rest = way[-1]
            further = next((one for one in rest if one in uses and one not in seen), None)
            if further is None:
                ordered.append(here)
                way.pop()
            else:
                seen.add(further)
                way.append((further, iter(uses[further])))
    return ordered


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
        try:
            parameter(tree.AtomUse(first, span=first.span), scope, number)
        except TooDeepError:
            scope.report(rule_messages.too_deep("parameter", first))
        except TooLargeError:
            scope.report(rule_messages.too_large("parameter", first))
        yield from scope.mistakes
        if scope.mistakes:
            constants.numbers[name] = None


def _check_definition(
    item: tree.DefineItem, symbols: SymbolTable, constants: ConstantsAndMacros
) -> list[Diagnostic]:
    mistakes: list[Diagnostic] = []
    typed = tuple(parameter_ for parameter_ in item.parameters if parameter_.type is not None)
    variables = variables_of(typed, symbols, mistakes)
    seen: dict[str, tree.Parameter] = {}
    for parameter_ in item.parameters:
        first = seen.setdefault(parameter_.name.text, parameter_)
        # Two with types have been found already.
        if first is not parameter_ and (first.type is None or parameter_.type is None):
            mistakes.append(twice("parameter", parameter_.name, first.span))
    scope = Scope(
        symbols,
        constants,
        variables,
        mistakes,
        relations={
            parameter_.name.text: AnyArgument()
            for parameter_ in item.parameters
            if parameter_.type is None
        },
        calls=(Call(item.name.text, None),),
        taken=frozenset(parameter_.name.text for parameter_ in item.parameters),
        of_definition=True,
    )
    result = None
    try:
        result = elaborate(item.body, scope)
    except TooDeepError:
        scope.report(rule_messages.too_deep("definition", item.name))
    except TooLargeError:
        scope.report(rule_messages.too_large("definition", item.name))
    wrong = any(mistake.severity == "error" for mistake in mistakes)
    if wrong or not constants.broken.isdisjoint(names_used(item)):
        constants.broken.add(item.name.text)
    elif result is not None:
        mistakes += (
            rule_messages.unused_parameter(item, parameter_)
            for parameter_ in item.parameters
            if parameter_.name.text not in scope.used
        )
    return mistakes
