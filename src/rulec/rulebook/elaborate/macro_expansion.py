"""Expansion of definitions and parameters at their uses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from rulec.diagnostics import Span
from rulec.logic.formula import Atom, Formula
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate import constant_messages as say
from rulec.rulebook.elaborate.scope import SIDES, AnyArgument, BoundVariable, Call, Evaluate, Scope
from rulec.rulebook.overlay.rulebook_overlay import Value, in_force, never_in_force
from rulec.syntax import tree
from rulec.vocabulary.dimensions import DIMENSIONS, Dimension

_Meaning = TypeVar("_Meaning")


def expand_macro(
    use: tree.AtomUse, scope: Scope, evaluate: Callable[[tree.Formula, Scope], _Meaning]
) -> _Meaning | None:
    """Expand the use of a definition; None after a reported mistake."""
    name = use.name.text
    item = scope.constants.overlay.definitions[name]
    if _closes_circle(use, "definition", scope):
        return None
    if len(use.arguments) != len(item.parameters):
        scope.used |= {argument.text for argument in use.arguments}
        scope.report_wrong_arity(use, say.wrong_number_of_arguments(use, item, scope.symbols))
        return None
    variables: dict[str, BoundVariable] = {}
    relations: dict[str, str | AnyArgument] = {}
    given: dict[str, Span] = {}
    for parameter, argument in zip(item.parameters, use.arguments, strict=True):
        local, type_ = parameter.name.text, parameter.type
        relation = _relation(argument, scope)
        if type_ is None and relation is not None:
            relations[local] = relation
            given[local] = scope.given.get(argument.text, argument.span)
            continue
        wanted = type_.text if type_ is not None and type_.text in scope.symbols.types else None
        others = scope.relation_names() if type_ is None else []
        actual = scope.object(argument, wanted, relations=others)
        if actual is not None:
            outer = scope.variables.get(argument.text)
            kind = wanted if outer is None else outer.type
            variables[local] = BoundVariable(kind, argument.span, actual)
    known = len(variables) + len(relations)
    if known < len(item.parameters) or name in scope.constants.broken:
        return None
    inner = replace(
        scope,
        variables=variables,
        relations=relations,
        given=given,
        calls=(*scope.calls, Call(name, use.span)),
        used=set(),
        owner="definition",
    )
    meaning = evaluate(item.body, inner)
    if isinstance(meaning, Formula):
        use_of = Atom(name, tuple([_actual(argument, scope) for argument in use.arguments]))
        scope.constants.defined[use_of] = meaning
    return meaning


def _actual(argument: tree.Name, scope: Scope) -> str:
    """The name by which the rule knows an argument."""
    name = argument.text
    known = scope.variables.get(name)
    relation = scope.relations.get(name, name)
    return known.actual if known else relation if isinstance(relation, str) else name


def _closes_circle(use: tree.AtomUse, kind: str, scope: Scope) -> bool:
    """Whether a definition or parameter depends on itself; if so, report it."""
    names = {call.name for call in scope.calls}
    if use.name.text not in names:
        return False
    scope.report(say.circle(use, kind, scope))
    scope.constants.broken |= names
    return True


def _relation(argument: tree.Name, scope: Scope) -> str | AnyArgument | None:
    name = argument.text
    if name in scope.relations:
        scope.used.add(name)
        return scope.relations[name]
    if name in scope.variables:
        return None
    if scope.behind(name) is not None or name in SIDES or scope.constants.overlay.kind_of(name):
        return name
    return None


def parameter_value(use: tree.AtomUse, scope: Scope, evaluate: Evaluate) -> NumberByCases | None:
    """The value of a parameter on the day in question; None after a reported mistake."""
    if _closes_circle(use, "parameter", scope):
        return None
    known = scope.constants.numbers
    if use.name.text not in known:
        value = _value_in_force(use, scope)
        known[use.name.text] = None if value is None else _evaluated(use, value, scope, evaluate)
    return known[use.name.text]


def _value_in_force(use: tree.AtomUse, scope: Scope) -> Value | None:
    name, day = use.name.text, scope.constants.at
    values = scope.constants.overlay.parameters[name]
    good = [value for value in values if in_force(value.item.in_force, day)]
    level = max((value.level for value in good), default=0)
    nearest = [value for value in good if value.level == level]
    if len(nearest) > 1:
        scope.report(say.two_values_in_force(nearest, name, day))
    if not nearest and not any(never_in_force(value.item.in_force) for value in values):
        scope.report(say.no_value_in_force(use, values, day))
    return nearest[0] if nearest else None


def _evaluated(
    use: tree.AtomUse, value: Value, scope: Scope, evaluate: Evaluate
) -> NumberByCases | None:
    name, item = use.name.text, value.item
    assert not isinstance(item.value, bool), "only an option is on or off"
    inner = replace(
        scope,
        variables={},
        relations={},
        calls=(*scope.calls, Call(name, None)),
        counted=frozenset(),
        taken=frozenset(),
        in_moment=True,
        used=set(),
    )
    with scope.constants.one_deeper():
        number = evaluate(item.value, inner)
    if number is None:
        return None
    wanted = _dimension(name, value, inner, evaluate)
    if wanted is not None and number.dimension not in (None, wanted):
        first = scope.constants.overlay.declared_at[name]
        scope.report(say.parameter_of_another_kind(item, number, wanted, first))
        return None
    if number.dimension is not None:
        return number
    # A bare 0 has the dimension that is asked for.
    dimension = wanted or DIMENSIONS["number"]
    zeros = ((when, replace(linear, dimension=dimension)) for when, linear in number.cases)
    return NumberByCases(tuple(zeros))


def _dimension(name: str, value: Value, scope: Scope, evaluate: Evaluate) -> Dimension | None:
    """The declared dimension, else that of the first value.

    None if that is unknown or the one at hand.
    """
    values = scope.constants.overlay.parameters[name]
    items = [value.item for value in values if isinstance(value.item, tree.ParamItem)]
    names = [item.dimension.text for item in items if item.dimension is not None]
    declared = DIMENSIONS.get(names[0]) if names else None
    first = values[0]
    if declared is not None or first is value or isinstance(first.item.value, bool):
        return declared
    number = evaluate(first.item.value, replace(scope, mistakes=[]))
    return None if number is None else number.dimension
