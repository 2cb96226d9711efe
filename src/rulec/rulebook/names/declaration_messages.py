"""What is said about declarations that are wrong."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rulec.diagnostics import Diagnostic, Label, Span, any_of, did_you_mean, named
from rulec.syntax import tree
from rulec.vocabulary.units import known_unit_names, unit_refusal

_OTHER_DIMENSIONS: Final = {
    "velocity": "speed",
    "weight": "mass",
    "period": "time",
    "height": "length",
    "width": "length",
    "gap": "length",
}


def unknown_type(name: tree.Name, known: Sequence[str]) -> Diagnostic:
    """No type of that name."""
    if known:
        way_out = f"known are {named(known)}; declare another by `type {name.text}`"
    else:
        way_out = f"declare it by `type {name.text}`, or `use` a vocabulary that has types"
    return Diagnostic(
        "R0201",
        f"there is no type `{name.text}`",
        name.span.place,
        expected="expected a type",
        help=did_you_mean(name.text, known) or way_out,
    )


def which_type(parameter: tree.Parameter, roots: Sequence[str]) -> Diagnostic:
    """A parameter without a type, where there is more than one possibility or none."""
    why = any_of([f"`{root}`" for root in roots]) if roots else "no type is declared"
    example = roots[0] if roots else "road_user"
    return Diagnostic(
        "R0308",
        f"it is not clear which objects `{parameter.name.text}` stands for: {why}",
        parameter.span.place,
        expected="expected a type behind the name",
        help=f"write `{parameter.name.text}: {example}`",
    )


def no_such_value(name: tree.Name, chosen: tree.Name, values: tuple[str, ...]) -> Diagnostic:
    """A default that is none of its enumeration's values."""
    return Diagnostic(
        "R0305",
        f"`{chosen.text}` is not a value of `{name.text}`",
        chosen.span.place,
        expected="expected one of its values",
        help=did_you_mean(chosen.text, values) or f"its values are {named(values)}",
    )


def twice(what: str, again: tree.Name, first: Span) -> Diagnostic:
    """A type, a name, a parameter or a variable declared a second time."""
    return Diagnostic(
        "R0204",
        f"the {what} `{again.text}` is declared twice",
        again.span.place,
        expected="declared again here",
        help="give it another name, or leave it out",
        labels=(Label(first.place, "first declared here"),),
    )


def both_declare(names: Sequence[str], first: tree.UseLine, again: tree.UseLine) -> Diagnostic:
    """Two vocabularies that cannot be used together, since they share names."""
    one, other = first.name.text, again.name.text
    return Diagnostic(
        "R0204",
        f"the vocabularies `{one}` and `{other}` both declare {named(sorted(set(names)))}",
        again.span.place,
        expected=f"cannot be used beside `{one}`",
        help="use one of them, and declare here what you miss of the other",
        labels=(Label(first.span.place, f"`{one}` is used here"),),
    )


def unknown_unit(item: tree.QuantityItem, name: tree.Name) -> Diagnostic:
    """A quantity in a unit that nobody knows, or that cannot be converted exactly."""
    refusal = unit_refusal(item.unit)
    if refusal is not None:
        message = f"the unit `{item.unit}` of `{name.text}` cannot be used: {refusal.why}"
        return Diagnostic(
            "R0209",
            message,
            item.unit_span.place,
            help=refusal.instead,
        )
    return Diagnostic(
        "R0209",
        f"there is no unit `{item.unit}`",
        item.unit_span.place,
        expected="expected a unit of measure",
        help=unit_help(item.unit),
    )


def unit_help(unit: str) -> str:
    """The way out of an unknown unit."""
    if unit in ("step", "steps"):
        return "steps count in the bounds of temporal operators only, such as `next[2 steps]`"
    near = did_you_mean(unit, known_unit_names())
    return near or "units are such as `m`, `km/h`, `s`, `m/s^2`, `t`, `%`"


def unknown_dimension(name: tree.Name, known: Sequence[str]) -> Diagnostic:
    """A kind of number that nobody knows."""
    other = _OTHER_DIMENSIONS.get(name.text.casefold())
    way_out = f"write `{other}`" if other else did_you_mean(name.text, known)
    return Diagnostic(
        "R0210",
        f"there is no kind of number `{name.text}`",
        name.span.place,
        expected="expected a kind of number",
        help=way_out or f"known are {named(known)}",
    )
