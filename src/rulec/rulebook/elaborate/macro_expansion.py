"""Expansion of definitions and parameters at their uses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, offering
from rulec.logic.formula import Atom, Formula
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate.elaboration_messages import hour_meant, kind_of, origins, short
from rulec.rulebook.elaborate.scope import SIDES, AnyArgument, BoundVariable, Call, Evaluate, Scope
from rulec.rulebook.names.atom_messages import (
    MIXED_DIMENSIONS,
    NOT_BOOLEAN,
    WRONG_ARITY,
    says_nothing_of,
)
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.rulebook_overlay import Value, in_force, never_in_force
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_parameters
from rulec.vocabulary.dimensions import (
    ACCELERATION,
    ANGLE,
    DIMENSIONS,
    LENGTH,
    MASS,
    NUMBER,
    SPEED,
    TIME,
    Dimension,
)

CIRCULAR_DEFINITION = Code(
    "R0316",
    title="a definition or a parameter refers to itself",
    why="A definition replaces its name, so it cannot contain itself, not even indirectly.",
    bad="rulebook example\nsignal wet\ndefine slippery = wet or slippery\n"
    "hard rule r { require never slippery }\n",
    good="rulebook example\nsignal wet\ndefine slippery = wet\n"
    "hard rule r { require never slippery }\n",
)

NO_SINGLE_VALUE = Code(
    "R0320",
    title="a parameter has no value on the day in question, or two",
    why="Values can be dated by `in force from … until …`. The day is the requested one, else "
    "that of the rulebook's `law` line, else today. On that day there must be exactly one value.",
    bad='rulebook example\nlaw "Highway Code" as of 2019-01-01\nquantity gap in m default 9\n'
    "param least : length = 1.5 m in force from 2020-04-28\n"
    "hard rule r { require always gap >= least }\n",
    good='rulebook example\nlaw "Highway Code" as of 2019-01-01\nquantity gap in m default 9\n'
    "param least : length = 1 m in force until 2020-04-27\n"
    "param least : length = 1.5 m in force from 2020-04-28\n"
    "hard rule r { require always gap >= least }\n",
)


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
        scope.report_wrong_arity(use, _wrong_number_of_arguments(use, item, scope.symbols))
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
    scope.report(_circle(use, kind, scope))
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
        scope.report(_two_values_in_force(nearest, name, day))
    if not nearest and not any(never_in_force(value.item.in_force) for value in values):
        scope.report(_no_value_in_force(use, values, day))
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
        scope.report(_parameter_of_another_kind(item, number, wanted, first))
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


def takes_no_object(use: tree.AtomUse, kind: str, scope: Scope) -> Diagnostic:
    """``pace(v)`` where ``pace`` is an option or a parameter."""
    return WRONG_ARITY.at(
        use.span,
        f"`{use.name.text}` is {'an' if kind == 'option' else 'a'} {kind} and about no object",
        expected="expected no parentheses",
        help=offering(f"write `{use.name.text}`", use.name.text),
        labels=origins(scope, use),
    )


def object_as_relation(use: tree.AtomUse, scope: Scope) -> Diagnostic:
    """``v(w)`` where v is an object."""
    name = use.name.text
    variable = scope.variables[name]
    role = (
        "is an object" if variable.actual == name else f"stands for the object `{variable.actual}`"
    )
    return NOT_BOOLEAN.at(
        use.span,
        f"`{name}` {role} and cannot be said of another one",
        expected="expected a signal, a value or a definition before `(`",
        help=f"write such as `near({name})`, or give the definition a relation for it",
        labels=(Label(variable.span.place, f"`{variable.actual}` comes from here"),),
    )


def _wrong_number_of_arguments(
    use: tree.AtomUse, item: tree.DefineItem, symbols: SymbolTable
) -> Diagnostic:
    """A definition used with too few or too many arguments.

    What is expected has the arguments that the user wrote, not the names of the parameters, which
    mean nothing where the definition is used.
    """
    needed, given = len(item.parameters), len(use.arguments)
    things = {0: "nothing", 1: "one thing"}.get(needed, f"{needed} things")
    has = {0: "none is", 1: "one is"}.get(given, f"{given} are")
    names = [argument.text for argument in use.arguments]
    written = names if given < needed else []
    arguments = ", ".join([*written, *["…"] * needed][:needed])
    head = f"{item.name.text}{print_parameters(item.parameters)}"
    origin = f"defined here as `{head}`" if needed else f"`{item.name.text}` is defined here"
    return WRONG_ARITY.at(
        use.span,
        f"`{item.name.text}` takes {things}, and {has} given",
        expected=f"expected `{item.name.text}{f'({arguments})' if needed else ''}`",
        help=(
            "give it as many as its definition has"
            if given < needed
            else says_nothing_of(item.name.text, names, needed, symbols)
        ),
        labels=(Label(item.name.span.place, origin),),
    )


def _circle(use: tree.AtomUse, kind: str, scope: Scope) -> Diagnostic:
    name = use.name.text
    names = [*(call.name for call in scope.calls), name]
    chain = " uses ".join(f"`{used}`" for used in names[names.index(name) :])
    return CIRCULAR_DEFINITION.at(
        use.span,
        f"the {kind} `{name}` is made of itself: {chain}",
        expected="this closes the circle",
        help="say it without itself",
    )


def _no_value_in_force(use: tree.AtomUse, values: Sequence[Value], day: str) -> Diagnostic:
    name = use.name.text
    return NO_SINGLE_VALUE.at(
        use.span,
        f"the parameter `{name}` has no value that is in force on {day}",
        expected="a value is needed here",
        help=f"give it one for that day, such as `param {name} = … in force from DATE`, "
        "or ask for another day",
        labels=tuple(Label(value.item.span.place, "a value is here") for value in values),
    )


def _two_values_in_force(values: Sequence[Value], name: str, day: str) -> Diagnostic:
    return NO_SINGLE_VALUE.at(
        values[1].item.span,
        f"the parameter `{name}` has two values that are in force on {day}",
        expected="the second one",
        help="end the older one by `in force until` the day before the newer one begins",
        labels=(Label(values[0].item.span.place, "the first one"),),
    )


def _parameter_of_another_kind(
    item: tree.ParamItem | tree.SetItem, number: NumberByCases, wanted: Dimension, first: tree.Name
) -> Diagnostic:
    assert not isinstance(item.value, bool), "only an option is on or off"
    usual = _usual_unit(wanted)
    if wanted == NUMBER:
        way_out: Help = "leave the unit out"
    elif number.dimension == NUMBER and usual:
        written = f"{short(item.value)} {usual}"
        way_out = offering(f"write the unit, such as `{written}`", written)
    else:
        such = f": a {wanted.name} is in {usual}, say" if usual else ""
        slip = hour_meant(item.value) if isinstance(item.value, tree.NumberLiteral) else ""
        way_out = slip or f"check the unit{such}"
    return MIXED_DIMENSIONS.at(
        item.value.span,
        f"`{item.name.text}` is a {wanted.name}, and `{short(item.value)}` "
        f"{kind_of(number.dimension)}",
        expected=f"expected a {wanted.name}",
        help=way_out,
        labels=() if first is item.name else (Label(first.span.place, "its kind is given here"),),
    )


def _usual_unit(dimension: Dimension) -> str:
    units = {ACCELERATION: "m/s^2", ANGLE: "deg", LENGTH: "m", MASS: "kg", SPEED: "km/h", TIME: "s"}
    return units.get(dimension, "")
