"""Messages about options, parameters and definitions, and their values."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, offering
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate.elaboration_messages import hour_meant, kind_of, origins, short
from rulec.rulebook.elaborate.scope import Scope
from rulec.rulebook.names.atom_messages import (
    MIXED_DIMENSIONS,
    NOT_BOOLEAN,
    WRONG_ARITY,
    says_nothing_of,
)
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.rulebook_overlay import Value
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_parameters
from rulec.vocabulary.dimensions import (
    ACCELERATION,
    ANGLE,
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
    bad="rulebook example\nsignal wet\ndefine slippery = wet⟪ or slippery|⟫\n"
    "hard rule r { require never slippery }\n",
)

NO_SINGLE_VALUE = Code(
    "R0320",
    title="a parameter has no value on the day in question, or two",
    why="Values can be dated by `in force from … until …`. The day is the requested one, else "
    "that of the rulebook's `law` line, else today. On that day there must be exactly one value.",
    bad='rulebook example\nlaw "Highway Code" as of 2019-01-01\nquantity gap in m default 9\n'
    "param least : length = 1⟪| m in force until 2020-04-27\n"
    "param least : length = 1⟫.5 m in force from 2020-04-28\n"
    "hard rule r { require always gap >= least }\n",
)


def takes_no_object(use: tree.AtomUse, kind: str, scope: Scope) -> Diagnostic:
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


def wrong_number_of_arguments(
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


def circle(use: tree.AtomUse, kind: str, scope: Scope) -> Diagnostic:
    name = use.name.text
    names = [*(call.name for call in scope.calls), name]
    chain = " uses ".join(f"`{used}`" for used in names[names.index(name) :])
    return CIRCULAR_DEFINITION.at(
        use.span,
        f"the {kind} `{name}` is made of itself: {chain}",
        expected="this closes the circle",
        help="say it without itself",
    )


def no_value_in_force(use: tree.AtomUse, values: Sequence[Value], day: str) -> Diagnostic:
    name = use.name.text
    return NO_SINGLE_VALUE.at(
        use.span,
        f"the parameter `{name}` has no value that is in force on {day}",
        expected="a value is needed here",
        help=f"give it one for that day, such as `param {name} = … in force from DATE`, "
        "or ask for another day",
        labels=tuple(Label(value.item.span.place, "a value is here") for value in values),
    )


def two_values_in_force(values: Sequence[Value], name: str, day: str) -> Diagnostic:
    return NO_SINGLE_VALUE.at(
        values[1].item.span,
        f"the parameter `{name}` has two values that are in force on {day}",
        expected="the second one",
        help="end the older one by `in force until` the day before the newer one begins",
        labels=(Label(values[0].item.span.place, "the first one"),),
    )


def parameter_of_another_kind(
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
