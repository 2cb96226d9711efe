"""Messages about two numbers of different dimensions, compared or added."""

from __future__ import annotations

from fractions import Fraction
from typing import TypeAlias

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.ways_out import Help, offering, write
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate.elaboration_messages import hour_meant, kind_of, origins, short
from rulec.rulebook.elaborate.scope import Scope
from rulec.rulebook.names.atom_messages import MIXED_DIMENSIONS
from rulec.syntax import tree
from rulec.vocabulary import Quantity
from rulec.vocabulary.dimensions import DIMENSIONS

_Side: TypeAlias = tuple[tree.Formula, NumberByCases]


def two_dimensions(
    node: tree.Compare | tree.Arithmetic | tree.Conditional,
    left: NumberByCases,
    right: NumberByCases,
    scope: Scope,
) -> Diagnostic:
    first, second, verb = _sides(node)
    first_kind, second_kind = kind_of(left.dimension), kind_of(right.dimension)
    return MIXED_DIMENSIONS.at(
        second.span,
        f"`{short(first)}` is {first_kind} and `{short(second)}` {second_kind}: "
        f"they cannot be {verb}",
        expected=f"this is {second_kind}",
        help=_help(node, (first, left), (second, right), scope),
        labels=(Label(first.span.place, f"this is {first_kind}"), *origins(scope, first, second)),
    )


def bare_beside_share(
    node: tree.Compare | tree.Arithmetic | tree.Conditional,
    left: NumberByCases,
    share: str,
    scope: Scope,
) -> Diagnostic:
    """The error for a number without a unit beside one in a unit such as `%`, the ``share``."""
    first, second, verb = _sides(node)
    bare, other = (first, second) if left.is_bare else (second, first)
    return MIXED_DIMENSIONS.at(
        bare.span,
        f"`{short(bare)}` has no unit and `{short(other)}` is in {share}: they cannot be {verb}",
        expected="this has no unit",
        help=_unit_help(bare, other, scope)
        or _parameter_help(bare, kind_of(None), other, scope)
        or f"write the unit, {share}",
        labels=(Label(other.span.place, f"this is in {share}"), *origins(scope, first, second)),
    )


def _sides(
    node: tree.Compare | tree.Arithmetic | tree.Conditional,
) -> tuple[tree.Formula, tree.Formula, str]:
    """What stands on both sides, and what cannot be done with numbers of two kinds."""
    if isinstance(node, tree.Conditional):
        return node.value, node.otherwise, "one number"
    sign = node.relation if isinstance(node, tree.Compare) else node.operator
    return node.left, node.right, {"+": "added", "-": "subtracted"}.get(sign, "compared")


def _help(node: tree.Formula, left: _Side, right: _Side, scope: Scope) -> Help:
    """The suggested correction of ``node``, which has these two sides."""
    (first, one), (second, other) = left, right
    return (
        _unit_help(second, first, scope)
        or _unit_help(first, second, scope)
        or _speed_help(left, right, scope)
        or _other_unit(second, first, node, scope)
        or _other_unit(first, second, node, scope)
        or _parameter_help(second, kind_of(other.dimension), first, scope)
        or _parameter_help(first, kind_of(one.dimension), second, scope)
        or _kind_help(left, right, scope)
        or "check the names and the units"
    )


_KILOGRAMS = 100
"""From this number on, a mass without a unit is rather one in kilograms than in tonnes."""


def _unit_help(node: tree.Formula, beside: tree.Formula, scope: Scope) -> Help:
    unit = scope.symbols.unit_text(beside.name.text) if isinstance(beside, tree.AtomUse) else ""
    number = node.operand if isinstance(node, tree.Minus) else node
    if not (isinstance(number, tree.NumberLiteral) and not number.unit and unit):
        return ""
    is_heavy = unit == "t" and float(number.text) >= _KILOGRAMS
    written = f"{short(node)} {'kg' if is_heavy else unit}"
    return offering(f"write the unit, such as `{written}`", write(written, node.span))


def _parameter_help(node: tree.Formula, kind: str, beside: tree.Formula, scope: Scope) -> str:
    """Help for a parameter without a unit, or of another dimension than what is beside it."""
    unit = scope.symbols.unit_text(beside.name.text) if isinstance(beside, tree.AtomUse) else ""
    is_param = isinstance(node, tree.AtomUse) and scope.constants.overlay.kind_of(node.name.text)
    if is_param != "parameter" or not unit:
        return ""
    if kind == "a number":
        return f"write its unit where it is declared, such as `param {short(node)} = 3 {unit}`"
    return f"`{short(beside)}` is in {unit}: check the unit of `{short(node)}` where it is declared"


def _other_unit(
    node: tree.Formula, beside: tree.Formula, whole: tree.Formula, scope: Scope
) -> Help:
    """Help for a number of another dimension than what it stands beside in ``whole``."""
    unit = scope.symbols.unit_text(beside.name.text) if isinstance(beside, tree.AtomUse) else ""
    if not (isinstance(node, tree.NumberLiteral) and unit):
        return ""
    if node.unit == "%":
        if isinstance(whole, tree.Arithmetic):
            return f"a share is a factor: for 10 % more write `1.1 * {short(beside)}`"
        # Of what it is beside, it would be a comparison of something with itself.
        return f"say what it is a share of, such as `{short(node)} * x` for a quantity `x`"
    slip = hour_meant(node) or _in_other_letters(node, beside, scope)
    return slip or f"`{short(beside)}` is in {unit}: check the unit of `{short(node)}`"


def _in_other_letters(node: tree.NumberLiteral, beside: tree.Formula, scope: Scope) -> Help:
    """Help for a unit in the wrong case, such as `T` for tonnes."""
    unit = scope.symbols.unit_text(beside.name.text) if isinstance(beside, tree.AtomUse) else ""
    wanted = scope.symbols.unit(unit)
    for written in (node.unit.lower(), node.unit.upper()):
        meant = scope.symbols.unit(written)
        if wanted is not None and meant is not None and meant.dimension == wanted.dimension:
            amount = f"{node.text} {written}"
            text = f"write `{amount}`: units are told apart by their case"
            return offering(text, write(amount, node.span))
    return ""


def _kind_help(
    first: _Side,
    second: _Side,
    scope: Scope,
) -> str:
    if first[1].dimension is not None and second[1].dimension is not None:
        ratio = first[1].dimension / second[1].dimension
        if DIMENSIONS["time"] in (ratio, ratio**-1):
            more, less = (first, second) if ratio == DIMENSIONS["time"] else (second, first)
            node = less[0]
            text = short(node)
            factor = f"({text})" if isinstance(node, tree.Arithmetic | tree.Minus) else text
            if by_units := _by_units(more[0], node, factor, scope):
                return by_units
            return f"a time makes them alike, such as `2 s * {factor}`"
    return ""


def _by_units(more: tree.Formula, less: tree.Formula, factor: str, scope: Scope) -> str:
    """Help for half the speedometer, `speed / 2`, which is meant for as many metres."""
    names = [
        node.name.text
        for node in (more, *((less.left, less.right) if isinstance(less, tree.Arithmetic) else ()))
        if isinstance(node, tree.AtomUse)
    ]
    units = [(text, scope.symbols.unit(text)) for text in map(scope.symbols.unit_text, names)]
    if len(units) != 2 or not isinstance(less, tree.Arithmetic) or less.operator not in "*/":
        return ""
    number = next((x for x in (less.left, less.right) if isinstance(x, tree.NumberLiteral)), None)
    of_time = ""
    if less.operator == "*" and number is not None and not number.unit:
        of_time = f"the way in {number.text} s write `{number.text} s * {names[1]}`"
    (of_more, whole), (of_less, part) = units
    if whole is None or part is None:
        return of_time and f"for {of_time}"
    seconds = f"{float(whole.factor / part.factor):g}"
    if Fraction(seconds) != whole.factor / part.factor:
        return of_time and f"for {of_time}"
    by_numbers = f"for 1 {of_more} to each {of_less} write `{seconds} s * {factor}`"
    return f"{by_numbers}, or for {of_time}" if of_time else by_numbers


_LENGTH_AND_TIME = (DIMENSIONS["length"], DIMENSIONS["time"])


def _speed_help(
    left: _Side,
    right: _Side,
    scope: Scope,
) -> Help:
    """Help for a length beside a time, if the vocabulary has ego's speed."""
    symbols = scope.symbols
    speeds = [
        name
        for name, item in symbols.items.items()
        if isinstance(item, Quantity)
        and not item.parameters
        and (unit := symbols.unit(item.unit)) is not None
        and unit.dimension == DIMENSIONS["speed"]
    ]
    for (_, cases), (node, other) in ((left, right), (right, left)):
        if speeds and (cases.dimension, other.dimension) == _LENGTH_AND_TIME:
            way, length = f"{short(node)} * {speeds[0]}", ""
            way_out = f"a speed makes a length of a time: `{way}`"
            if isinstance(node, tree.NumberLiteral) and node.unit:
                length = f"{node.text} m"
                way_out = f"write `{length}`, or, as {way_out}"
            # Which of the two is meant, only the author knows.
            both = (length, way) if length else ()
            return offering(way_out, *(write(one, node.span) for one in both))
    return ""
