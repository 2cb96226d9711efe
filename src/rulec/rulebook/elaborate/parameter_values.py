"""The value of a parameter on the day in question."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate import constant_messages as say
from rulec.rulebook.elaborate.scope import Call, Scope
from rulec.rulebook.overlay.constants_and_macros import in_force
from rulec.rulebook.overlay.rulebook_overlay import Value, never_in_force
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS, Dimension

Evaluate = Callable[[tree.Formula, Scope], NumberByCases | None]


def parameter(use: tree.AtomUse, scope: Scope, evaluate: Evaluate) -> NumberByCases | None:
    """Value of a parameter; None after a reported mistake."""
    name = use.name.text
    if any(call.name == name for call in scope.calls):
        scope.report(say.circle(use, "parameter", scope))
        scope.constants.broken |= {call.name for call in scope.calls}
        return None
    known = scope.constants.numbers
    if name not in known:
        value = value_in_force(use, scope)
        known[name] = None if value is None else _evaluated(use, value, scope, evaluate)
    return known[name]


def value_in_force(use: tree.AtomUse, scope: Scope) -> Value | None:
    """The value in force, from the nearest rulebook that has any."""
    name, constants = use.name.text, scope.constants
    values = constants.overlay.parameters[name]
    good = [value for value in values if in_force(value.item.in_force, constants.at)]
    nearest = max((value.level for value in good), default=0)
    candidates = [value for value in good if value.level == nearest]
    if not candidates:
        if not any(never_in_force(value.item.in_force) for value in values):
            scope.report(say.no_value_in_force(use, values, constants.at))
        return None
    if len(candidates) > 1:
        scope.report(say.two_values_in_force(candidates, name, constants.at))
    return candidates[0]


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
    wanted = _dimension(name, scope)
    if wanted is None:
        wanted = _first_value(name, value, inner, evaluate)
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


def _dimension(name: str, scope: Scope) -> Dimension | None:
    """The declared dimension; None if there is none or an unknown one."""
    for value in scope.constants.overlay.parameters[name]:
        item = value.item
        if isinstance(item, tree.ParamItem) and item.dimension is not None:
            return DIMENSIONS.get(item.dimension.text)
    return None


def _first_value(name: str, value: Value, scope: Scope, evaluate: Evaluate) -> Dimension | None:
    """The dimension of the first value, for a declaration that names none."""
    first = scope.constants.overlay.parameters[name][0]
    if first is value or isinstance(first.item.value, bool):
        return None
    number = evaluate(first.item.value, replace(scope, mistakes=[]))
    return None if number is None else number.dimension
