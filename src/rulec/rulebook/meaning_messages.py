"""What is said about numbers, truths and objects where another of them is needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.logic.formula import Formula
from rulec.rulebook.declaration_messages import unit_help
from rulec.rulebook.numbers import Number
from rulec.rulebook.overlay import Value
from rulec.syntax import tree
from rulec.syntax.printer import print_formula
from rulec.vocabulary.units import DIMENSIONS, Dimension, unit_refusal

if TYPE_CHECKING:
    from rulec.rulebook.scope import Scope


def _kind(dimension: Dimension | None) -> str:
    return "a number" if dimension is None else f"a {dimension.name}"


def _short(node: tree.Formula) -> str:
    text = print_formula(node, "written")
    return text if len(text) <= 40 else f"{text[:39]}…"


def _what(found: object) -> str:
    """The kind of a meaning in words."""
    if isinstance(found, Number):
        return _kind(found.dimension)
    return "true or false" if isinstance(found, Formula) else "an object"


def _origins(node: tree.Formula, scope: Scope) -> Iterator[Label]:
    """Where the names in an expression come from."""
    match node:
        case tree.AtomUse(name):
            declared = scope.declared.spans.get(name.text)
            laid = scope.provisions.overlay
            provision = laid.changed_at.get(name.text) or laid.declared_at.get(name.text)
            span = declared or (provision.span if provision else None)
            if span is not None:
                yield Label(span.place, f"`{name.text}` is declared here")
        case tree.Arithmetic(_, left, right):
            yield from _origins(left, scope)
            yield from _origins(right, scope)
        case tree.Minus(operand):
            yield from _origins(operand, scope)
        case _:
            return


def _once(labels: Iterator[Label]) -> tuple[Label, ...]:
    return tuple(dict.fromkeys(labels))


def number_for_truth(node: tree.Formula, found: Number, scope: Scope) -> Diagnostic:
    """A number where a formula needs something true or false."""
    unit = ""
    if isinstance(node, tree.AtomUse):
        unit = scope.declared.unit_text(node.name.text)
    inside = f" (in {unit})" if unit else ""
    test = f"< 5 {unit}" if unit else ">= 1" if isinstance(node, tree.Aggregate) else "< …"
    return Diagnostic(
        "R0313",
        f"`{_short(node)}` is {_kind(found.dimension)}{inside} and cannot be true or false",
        node.span.place,
        expected="expected something that is true or false",
        help=f"compare it, such as `{_short(node)} {test}`",
        labels=_once(_origins(node, scope)),
    )


def object_for_truth(node: tree.Formula, scope: Scope) -> Diagnostic:
    """A variable where a formula needs something true or false."""
    example = next(iter(scope.declared.about_one()), "p")
    return Diagnostic(
        "R0303",
        f"`{_short(node)}` is an object and cannot be true or false",
        node.span.place,
        expected="expected a signal or a value",
        help=f"say something about it, such as `{example}({_short(node)})`",
    )


def no_number(node: tree.Formula, found: object, scope: Scope) -> Diagnostic:
    """Something true or false, or an object, where a number is needed."""
    return Diagnostic(
        "R0313",
        f"`{_short(node)}` is {_what(found)}, not a number",
        node.span.place,
        expected="expected a number",
        help="a number is a quantity, a parameter, a count, or such as `1.5 m`",
        labels=_once(_origins(node, scope)),
    )


def not_comparable(
    node: tree.Formula, found: object, around: tree.Compare, scope: Scope
) -> Diagnostic:
    """A side of a comparison that is no number."""
    way_out = "numbers are compared, and objects by `=` and `!=`"
    if isinstance(found, Formula) and around.relation in ("=", "!="):
        sign = "iff" if around.relation == "=" else "xor"
        way_out = f"formulas are compared by `{sign}`"
    return Diagnostic(
        "R0313",
        f"`{_short(node)}` is {_what(found)}, not a number",
        node.span.place,
        expected=f"expected a number beside `{around.relation}`",
        help=way_out,
        labels=_once(_origins(node, scope)),
    )


def two_dimensions(
    node: tree.Compare | tree.Arithmetic | tree.Conditional,
    left: Number,
    right: Number,
    scope: Scope,
) -> Diagnostic:
    """Numbers of two dimensions side by side."""
    if isinstance(node, tree.Conditional):
        first, second, sign = node.value, node.otherwise, "or"
    else:
        first, second = node.left, node.right
        sign = node.relation if isinstance(node, tree.Compare) else node.operator
    labels = [
        Label(first.span.place, f"this is {_kind(left.dimension)}"),
        *_origins(first, scope),
        *_origins(second, scope),
    ]
    one, other = _kind(left.dimension), _kind(right.dimension)
    verb = {"+": "added", "-": "subtracted", "or": "one number"}.get(sign, "compared")
    message = f"`{_short(first)}` is {one} and `{_short(second)}` {other}"
    return Diagnostic(
        "R0312",
        f"{message}: they cannot be {verb}",
        second.span.place,
        expected=f"this is {other}",
        help=_unit_help(second, first, scope)
        or _unit_help(first, second, scope)
        or _kind_help(first, left, second, right),
        labels=_once(iter(labels)),
    )


def _unit_help(node: tree.Formula, other: tree.Formula, scope: Scope) -> str:
    """A number without its unit."""
    if isinstance(node, tree.Number) and not node.unit and isinstance(other, tree.AtomUse):
        unit = scope.declared.unit_text(other.name.text)
        return f"write the unit, such as `{node.text} {unit}`" if unit else ""
    return ""


def _kind_help(first: tree.Formula, left: Number, second: tree.Formula, right: Number) -> str:
    """What one could be multiplied with to become the other."""
    if left.dimension is not None and right.dimension is not None:
        for node, ratio in (
            (second, left.dimension / right.dimension),
            (first, right.dimension / left.dimension),
        ):
            if ratio == DIMENSIONS["time"]:
                return f"a time makes them alike, such as `2 s * {_factor(node)}`"
    return "check the names and the units"


def _factor(node: tree.Formula) -> str:
    text = _short(node)
    return f"({text})" if isinstance(node, tree.Arithmetic | tree.Minus) else text


def two_kinds(node: tree.Conditional, value: object, otherwise: object, scope: Scope) -> Diagnostic:
    """``number if condition else truth``."""
    return Diagnostic(
        "R0313",
        f"`{_short(node.value)}` is {_what(value)} and `{_short(node.otherwise)}` "
        f"{_what(otherwise)}: they cannot stand for each other",
        node.otherwise.span.place,
        expected=f"this is {_what(otherwise)}",
        help="both sides of `if … else` are numbers, or both are true or false",
        labels=_once(_origins(node.value, scope)),
    )


def unknown_unit(node: tree.Number) -> Diagnostic:
    """A unit that nobody knows, or that cannot be converted exactly."""
    refusal = unit_refusal(node.unit)
    if refusal is not None:
        message = f"the unit `{node.unit}` cannot be used: {refusal.why}"
        return Diagnostic("R0209", message, node.span.place, help=refusal.instead)
    return Diagnostic(
        "R0209",
        f"there is no unit `{node.unit}`",
        node.span.place,
        expected="expected a unit of measure",
        help=unit_help(node.unit),
    )


def too_long(node: tree.Number) -> Diagnostic:
    """A number with more digits than anyone could mean."""
    return Diagnostic(
        "R0112",
        "this number has too many digits",
        node.span.place,
        help="write at most 400 digits, and no exponent beyond 400",
    )


def not_linear(node: tree.Arithmetic) -> Diagnostic:
    """A product of two numbers that vary, or a quotient by one."""
    if node.operator == "*":
        why = "two numbers that change from state to state cannot be multiplied"
        wanted = "on one side"
    else:
        why = "a number that changes from state to state cannot be divided by"
        wanted = "behind `/`"
    return Diagnostic(
        "R0314",
        f"`{_short(node)}`: {why}",
        node.span.place,
        expected=f"expected a fixed number {wanted}",
        help="multiply and divide by fixed numbers and parameters only",
    )


def divided_by_zero(node: tree.Arithmetic) -> Diagnostic:
    """A division by 0."""
    return Diagnostic(
        "R0314",
        f"`{_short(node)}` divides by 0",
        node.right.span.place,
        expected="expected a number other than 0",
        help="check the divisor",
    )


def too_many_cases(node: tree.Formula) -> Diagnostic:
    """A comparison with too many conditional numbers."""
    return Diagnostic(
        "R0323",
        f"`{_short(node)}` becomes too large, with parameters and conditions put in",
        node.span.place,
        help="use fewer numbers that have an `if`, or say it in several comparisons",
    )


def objects_have_no_order(node: tree.Compare) -> Diagnostic:
    """``v < w`` of objects."""
    return Diagnostic(
        "R0313",
        f"`{_short(node.left)}` and `{_short(node.right)}` are objects, which have no order",
        node.span.place,
        expected="expected `=` or `!=` between objects",
        help="compare numbers of theirs",
    )


def temporal_in_count(node: tree.Prefix | tree.Infix) -> Diagnostic:
    """A temporal operator in a count's body or a parameter."""
    return Diagnostic(
        "R0319",
        f"`{node.operator}` cannot stand here: a count, a parameter and a fact speak of one state",
        node.span.place,
        expected="expected a formula about one state",
        help="put the operator around it, or give the rule a variable",
    )


def unused_variable(node: tree.Aggregate) -> Diagnostic:
    """A count's variable that its body says nothing about."""
    name = node.variable.name.text
    return Diagnostic(
        "R0207",
        f"the formula says nothing about `{name}`",
        node.variable.span.place,
        expected="not used behind it",
        help="speak of it, or leave the variable out",
        severity="warning",
    )


def takes_no_object(use: tree.AtomUse, kind: str, scope: Scope) -> Diagnostic:
    """An option or a parameter with objects in parentheses."""
    return Diagnostic(
        "R0301",
        f"`{use.name.text}` is {'an' if kind == 'option' else 'a'} {kind} and about no object",
        use.span.place,
        expected="expected no parentheses",
        help=f"write `{use.name.text}`",
        labels=_once(_origins(use, scope)),
    )


def object_as_relation(use: tree.AtomUse, scope: Scope) -> Diagnostic:
    """``v(w)`` where v is an object."""
    name = use.name.text
    variable = scope.variables[name]
    said = (
        "is an object" if variable.actual == name else f"stands for the object `{variable.actual}`"
    )
    return Diagnostic(
        "R0303",
        f"`{name}` {said} and cannot be said of another one",
        use.span.place,
        expected="expected a signal, a value or a definition before `(`",
        help=f"write such as `near({name})`, or give the definition a relation for it",
        labels=(Label(variable.span.place, f"`{variable.actual}` comes from here"),),
    )


def wrong_number_of_arguments(use: tree.AtomUse, item: tree.DefineItem) -> Diagnostic:
    """A definition used with too few or too many objects."""
    names = ", ".join(one.name.text for one in item.parameters)
    shape = f"{item.name.text}({names})" if names else item.name.text
    needed, given = len(item.parameters), len(use.arguments)
    things = {0: "nothing", 1: "one thing"}.get(needed, f"{needed} things")
    has = {0: "none is", 1: "one is"}.get(given, f"{given} are")
    return Diagnostic(
        "R0301",
        f"`{item.name.text}` takes {things}, and {has} given",
        use.span.place,
        expected=f"expected `{shape}`",
        help="give it as many as its definition has",
        labels=(Label(item.name.span.place, f"`{item.name.text}` is defined here"),),
    )


def circle(use: tree.AtomUse, kind: str, scope: Scope) -> Diagnostic:
    """A definition or parameter that comes back to itself."""
    name = use.name.text
    first = next(at for at, call in enumerate(scope.calls) if call.name == name)
    chain = [f"`{call.name}`" for call in scope.calls[first:]]
    return Diagnostic(
        "R0316",
        f"the {kind} `{name}` is made of itself: {' uses '.join([*chain, f'`{name}`'])}",
        use.span.place,
        expected="this closes the circle",
        help="say it without itself",
    )


def no_value_in_force(use: tree.AtomUse, values: Sequence[Value], day: str) -> Diagnostic:
    """A parameter that has no value on the day."""
    name = use.name.text
    return Diagnostic(
        "R0320",
        f"the parameter `{name}` has no value that is in force on {day}",
        use.span.place,
        expected="a value is needed here",
        help=f"give it one for that day, such as `param {name} = … in force from DATE`, "
        "or ask for another day",
        labels=tuple(Label(value.item.span.place, "a value is here") for value in values),
    )


def two_values_in_force(values: Sequence[Value], name: str, day: str) -> Diagnostic:
    """A parameter with two values on one day."""
    first, second, *_ = values
    return Diagnostic(
        "R0320",
        f"the parameter `{name}` has two values that are in force on {day}",
        second.item.span.place,
        expected="the second one",
        help="end the first one by `in force until` the day before",
        labels=(Label(first.item.span.place, "the first one"),),
    )


def parameter_of_another_kind(
    item: tree.ParamItem | tree.SetItem, found: Number, wanted: Dimension, first: tree.Name
) -> Diagnostic:
    """A parameter's value of another dimension than it has."""
    assert not isinstance(item.value, bool), "only an option is on or off"
    return Diagnostic(
        "R0312",
        f"`{item.name.text}` is a {wanted.name}, and `{_short(item.value)}` "
        f"{_kind(found.dimension)}",
        item.value.span.place,
        expected=f"expected a {wanted.name}",
        help="check the unit",
        labels=() if first is item.name else (Label(first.span.place, "its kind is given here"),),
    )


def two_units_of_time(bound: tree.Bound) -> Diagnostic:
    """A bound from seconds to steps."""
    return Diagnostic(
        "R0317",
        "a bound is in units of time or in steps, not in both",
        bound.span.place,
        expected="expected one of them",
        help="write both ends in seconds, or both in steps",
    )


def wrong_form(node: tree.Prefix | tree.Infix, bound: tree.Bound) -> Diagnostic:
    """``next[<= 2 s]`` or ``eventually[2 s]``."""
    amount = bound.high or bound.low
    text = print_formula(amount) if amount else "2 s"
    if bound.exact:
        message = f"`{node.operator}` looks at a stretch of time, and this is an instant"
        way_out = f"write `[<= {text}]`, `[>= {text}]` or `[{text} .. {text}]`"
    else:
        message = f"`{node.operator}` looks at one instant, and this is a stretch of time"
        way_out = f"write `{node.operator}[{text}]`"
    return Diagnostic(
        "R0317", message, bound.span.place, expected="expected another bound", help=way_out
    )


def empty_bound(bound: tree.Bound) -> Diagnostic:
    """``[4 s .. 1 s]``."""
    return Diagnostic(
        "R0317",
        "the bound ends before it begins",
        bound.span.place,
        expected="expected the smaller number first",
        help="exchange the two",
    )


def half_a_step(side: tree.Number) -> Diagnostic:
    """``[<= 1.5 steps]``."""
    return Diagnostic(
        "R0317",
        f"there is no {side.text} of a step",
        side.span.place,
        expected="expected a whole number of steps",
        help="write a whole number, or a time in seconds",
    )


def no_time(side: tree.Amount, found: Number) -> Diagnostic:
    """A bound that is no fixed time from 0 on."""
    if not found.is_constant:
        why = "changes from state to state"
    elif found.dimension is None or found.cases[0][1].constant < 0:
        why = "is below 0"
    else:
        why = f"is {_kind(found.dimension)}"
    return Diagnostic(
        "R0317",
        f"`{_short(side)}` {why}; a bound is a fixed time",
        side.span.place,
        expected="expected a time",
        help="write a time, such as `3 s`, or a number of steps, such as `2 steps`",
    )


def no_stretch(unless: tree.Unless, scope: str, require: Span | None) -> Diagnostic:
    """A scope of an exception to a formula that guards no stretch of time."""
    written = f"`{scope}`" if unless.scope else "this exception"
    labels = () if require is None else (Label(require.place, "this is what the rule requires"),)
    return Diagnostic(
        "R0318",
        f"{written} speaks of a sequence, and the rule guards none: it does not begin with "
        "`never` or `always`",
        unless.span.place,
        expected="expected `initially`",
        help="write `initially`, which looks at the first state, or say what must `never` happen",
        labels=labels,
    )


def bounded_phase(unless: tree.Unless) -> Diagnostic:
    """``throughout`` phases whose length is bounded."""
    return Diagnostic(
        "R0318",
        "an exception cannot hold `throughout` phases whose length is bounded",
        unless.span.place,
        expected="expected another scope",
        help="write `at start`, `at end` or `at some point`, or leave the bounds of `then` out",
    )


def too_many_exceptions(unless: tree.Unless) -> Diagnostic:
    """More exceptions that hold throughout than a formula can take."""
    return Diagnostic(
        "R0323",
        "with this one, too many exceptions of the rule have to hold `throughout` its phases: "
        "each multiplies the formula",
        unless.span.place,
        help="join some of them by `or` in one `unless`, if one of them may follow the other",
    )
