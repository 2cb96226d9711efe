"""Definitions put in the place of their uses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from rulec.rulebook.elaborate import constant_messages as say
from rulec.rulebook.elaborate.scope import SIDES, AnyArgument, BoundVariable, Call, Scope
from rulec.syntax import tree

_Meaning = TypeVar("_Meaning")


def expand_macro(
    use: tree.AtomUse, scope: Scope, evaluate: Callable[[tree.Formula, Scope], _Meaning]
) -> _Meaning | None:
    """Expand the use of a definition; None after a reported mistake."""
    name = use.name.text
    item = scope.constants.definitions[name]
    if any(call.name == name for call in scope.calls):
        scope.report(say.circle(use, "definition", scope))
        scope.constants.broken |= {call.name for call in scope.calls}
        return None
    if len(use.arguments) != len(item.parameters):
        scope.used |= {argument.text for argument in use.arguments}
        scope.report(say.wrong_number_of_arguments(use, item))
        return None
    variables: dict[str, BoundVariable] = {}
    relations: dict[str, str | AnyArgument] = {}
    good = True
    for parameter, argument in zip(item.parameters, use.arguments, strict=True):
        local = parameter.name.text
        relation = _relation(argument, scope)
        if parameter.type is None and relation is not None:
            relations[local] = relation
            continue
        wanted = None if parameter.type is None else parameter.type.text
        if wanted is not None and wanted not in scope.symbols.types:
            wanted = None
        others = [] if parameter.type is not None else scope.relation_names()
        actual = scope.object(argument, wanted, relations=others)
        if actual is None:
            good = False
            continue
        outer = scope.variables.get(argument.text)
        kind = wanted if outer is None else outer.type
        variables[local] = BoundVariable(kind, argument.span, actual)
    if not good or name in scope.constants.broken:
        return None
    inner = replace(
        scope,
        variables=variables,
        relations=relations,
        calls=(*scope.calls, Call(name, use.span)),
        used=set(),
        of_definition=True,
    )
    return evaluate(item.body, inner)


def _relation(argument: tree.Name, scope: Scope) -> str | AnyArgument | None:
    """The relation that an argument names, if it names one."""
    name = argument.text
    if name in scope.relations:
        scope.used.add(name)
        return scope.relations[name]
    if name in scope.variables:
        return None
    if scope.behind(name) is not None or name in SIDES or scope.constants.overlay.kind_of(name):
        return name
    return None
