"""Messages about options, parameters and definitions, and their values."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, Span
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
from rulec.syntax.messages.larger_edits import exchanged
from rulec.syntax.tree_printer import print_formula, print_parameters
from rulec.vocabulary import Signal
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

OTHERWISE_DECLARED = Code("R0328")


SENSELESS_BOUND = Code("R0317")


CIRCULAR_DEFINITION = Code("R0316")

NO_SINGLE_VALUE = Code("R0320")


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


def two_units_of_time(bound: tree.BoundNode) -> Diagnostic:
    return SENSELESS_BOUND.at(
        bound.span,
        "a bound is in units of time or in steps, not in both",
        expected="expected one of them",
        help="write both ends in seconds, or both in steps",
    )


def wrong_form(node: tree.Prefix | tree.Infix, bound: tree.BoundNode) -> Diagnostic:
    """``next[<= 2 s]`` or ``eventually[2 s]``."""
    amount = bound.high or bound.low
    text = print_formula(amount) if amount else "2 s"
    if bound.exact:
        message = f"`{node.operator}` looks at a stretch of time, and this is an instant"
        way_out: Help = offering(
            f"write `[<= {text}]`, `[>= {text}]` or `[{text} .. {text}]`",
            f"[<= {text}]",
            f"[>= {text}]",
        )
    else:
        message = f"`{node.operator}` looks at one instant, and this is a stretch of time"
        instant = f"write `{node.operator}[{text}]`"
        if bound.high and not bound.low and node.operator in ("next", "previously"):
            within = "eventually" if node.operator == "next" else "once"
            instant += f" for that instant, `{within}[<= {text}]` for one on the way there"
        way_out = instant
    return SENSELESS_BOUND.at(bound.span, message, expected="expected another bound", help=way_out)


def empty_bound(bound: tree.BoundNode) -> Diagnostic:
    """``[4 s .. 1 s]``."""
    ends = [end.span.text for end in (bound.low, bound.high) if end is not None]
    return SENSELESS_BOUND.at(
        bound.span,
        "the bound ends before it begins",
        expected="expected the smaller number first",
        help=offering("exchange the two", *(exchanged(bound.span, *ends) if len(ends) > 1 else ())),
    )


def half_a_step(side: tree.NumberLiteral) -> Diagnostic:
    """``[<= 1.5 steps]``."""
    return SENSELESS_BOUND.at(
        side.span,
        f"there is no {side.text} of a step",
        expected="expected a whole number of steps",
        help="write a whole number, or a time in seconds",
    )


def no_time(side: tree.Amount, number: NumberByCases) -> Diagnostic:
    way_out = "write a time, such as `3 s`, or a number of steps, such as `2 steps`"
    if not number.is_constant:
        why = "changes from state to state"
    elif number.dimension is None or number.cases[0][1].constant < 0:
        why = "is below 0"
    else:
        why = f"is {kind_of(number.dimension)}"
        if number.dimension == LENGTH:
            way_out = "write a time, such as `3 s`; how far is compared, as in `gap(v) <= 100 m`"
    return SENSELESS_BOUND.at(
        side.span,
        f"`{short(side)}` {why}; a bound is a fixed time",
        expected="expected a time",
        help=way_out,
    )


def no_signal(item: tree.DefineItem, declared: Span | None) -> Diagnostic:
    return OTHERWISE_DECLARED.at(
        item.name.span,
        f"`{item.name.text}` is no signal",
        expected="only a signal can be defined",
        help="give the definition a name of its own",
        labels=() if declared is None else (Label(declared.place, "declared here"),),
    )


def other_objects(item: tree.DefineItem, declared: Signal, place: Span) -> Diagnostic:
    objects = ", ".join(declared.parameters)
    return OTHERWISE_DECLARED.at(
        item.name.span,
        f"`{item.name.text}` is about other objects than its definition",
        expected=f"expected `({objects})`" if objects else "expected no objects",
        help="define it for the objects that it is declared for",
        labels=(Label(place.place, "declared here"),),
    )


def looks_ahead(item: tree.DefineItem, operator: str) -> Diagnostic:
    return OTHERWISE_DECLARED.at(
        item.body.span,
        f"the definition of `{item.name.text}` looks ahead with `{operator}`",
        expected="expected the present or the past",
        help="use `once`, `historically`, `since` or `previously`",
    )


def meanings_circle(item: tree.DefineItem, names: tuple[str, ...]) -> Diagnostic:
    way = " → ".join(f"`{name}`" for name in names)
    return CIRCULAR_DEFINITION.at(
        item.name.span,
        f"the definition of `{names[0]}` goes round in a circle: {way}",
        expected="this word is among those that define it",
        help="say one of them without the others",
    )
