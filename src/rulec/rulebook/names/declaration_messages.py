"""Messages about declarations that are wrong."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

from rulec.diagnostics import Diagnostic, Label, Span, any_of, named, nearest_name
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, another_name, declared, meant, offering, write
from rulec.rulebook.names.word_meanings import DescribedWord, offer
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import name_left_out
from rulec.syntax.messages.literals import hours_meant, how_hours_are_written
from rulec.vocabulary.units import known_unit_names, unit_in_another_language, unit_refusal

UNKNOWN_TYPE = Code("R0201")

DECLARED_TWICE = Code("R0204")

UNKNOWN_UNIT = Code("R0209")

UNKNOWN_DIMENSION = Code("R0210")

TYPE_CIRCLE = Code("R0304")

UNFITTING_DEFAULT = Code("R0305")

PARAMETER_WITHOUT_TYPE = Code("R0308")

NOTHING_TO_MARK = Code("R0216")

NOT_TO_BE_PRESUMED = Code("R0325")


_OTHER_DIMENSIONS: Final = {
    "velocity": "speed",
    "weight": "mass",
    "period": "time",
    "height": "length",
    "width": "length",
    "gap": "length",
    **dict.fromkeys(("second", "seconds", "minutes", "hours"), "time"),
    **dict.fromkeys(("metre", "metres", "meters", "kilometres"), "length"),
}


def unknown_type(name: tree.Name, known: Sequence[str]) -> Diagnostic:
    declares = declared(f"type {name.text}", name.span)
    if known:
        way_out = f"known are {named(known)}; declare another by `type {name.text}`"
    else:
        way_out = f"declare it by `type {name.text}`, or `use` a vocabulary that has types"
    return UNKNOWN_TYPE.at(
        name.span,
        f"there is no type `{name.text}`",
        expected="expected a type",
        help=meant(name.text, known)
        or offer(name.text, tuple(map(DescribedWord, known)))
        or offering(way_out, declares),
    )


def which_type(parameter: tree.Parameter, roots: Sequence[str]) -> Diagnostic:
    why = any_of([f"`{root}`" for root in roots]) if roots else "no type is declared"
    example = roots[0] if roots else "road_user"
    return PARAMETER_WITHOUT_TYPE.at(
        parameter.span,
        f"it is not clear which objects `{parameter.name.text}` stands for: {why}",
        expected="expected a type after the name",
        help=offering(
            f"write `{parameter.name.text}: {example}`", f"{parameter.name.text}: {example}"
        ),
    )


def no_such_value(name: tree.Name, chosen: tree.Name, values: tuple[str, ...]) -> Diagnostic:
    return UNFITTING_DEFAULT.at(
        chosen.span,
        f"`{chosen.text}` is not a value of `{name.text}`",
        expected="expected one of its values",
        help=meant(chosen.text, values) or f"its values are {named(values)}",
    )


def twice(kind: str, again: tree.Name, first: Span) -> Diagnostic:
    return DECLARED_TWICE.at(
        again.span,
        f"the {kind} `{again.text}` is declared twice",
        expected="declared again here",
        help=offering(
            "give it another name, or leave it out",
            *name_left_out(again.span),
            another_name(again.span),
        ),
        labels=(Label(first.place, "first declared here"),),
    )


def marked_twice(
    item: tree.ConstantItem | tree.PresumedItem, again: tree.Name, first: Span
) -> Diagnostic:
    return DECLARED_TWICE.at(
        again.span,
        f"`{again.text}` is called {_mark(item)} twice",
        expected="said again here",
        help=offering("leave it out", *name_left_out(again.span)),
        labels=(Label(first.place, "first said here"),),
    )


def nothing_to_mark(
    item: tree.ConstantItem | tree.PresumedItem,
    name: tree.Name,
    known: Collection[str],
    enumeration: str = "",
) -> Diagnostic:
    """Mistake: a name is not declared; it may be a value of an enumeration."""
    signal = f"signal {name.text} default false"
    if enumeration:
        message = f"`{name.text}` is a value, and only what has values can be {_mark(item)}"
        way_out: Help = offering(f"write `{enumeration}`, whose value it is", enumeration)
    else:
        message = f"nothing is called `{name.text}` that could be {_mark(item)}"
        way_out = meant(name.text, list(known))
    return NOTHING_TO_MARK.at(
        name.span,
        message,
        expected="expected a signal, a quantity or an enumeration",
        help=way_out or offering(f"declare it, such as `{signal}`", declared(signal, name.span)),
    )


def no_default(name: tree.Name, known: Span) -> Diagnostic:
    return NOT_TO_BE_PRESUMED.at(
        name.span,
        f"`{name.text}` has no default that could be presumed",
        expected="expected a name that has a default",
        help=offering(
            "give it a default where it is declared, or leave it out here",
            *name_left_out(name.span),
        ),
        labels=(Label(known.place, "declared here"),),
    )


def too_many_presumed(name: tree.Name, number: int, most: int) -> Diagnostic:
    return NOT_TO_BE_PRESUMED.at(
        name.span,
        f"`{name.text}` is the {number}th name that is presumed; there may be {most}",
        expected="one more than can be presumed",
        help="presume only what is rare and no source could tell; leave the others unknown",
    )


def _mark(item: tree.ConstantItem | tree.PresumedItem) -> str:
    return "constant" if isinstance(item, tree.ConstantItem) else "presumed"


def both_declare(names: Sequence[str], first: tree.UseLine, again: tree.UseLine) -> Diagnostic:
    return DECLARED_TWICE.at(
        again.span,
        f"the vocabularies `{first.name.text}` and `{again.name.text}` both declare "
        f"{named(sorted(set(names)))}",
        expected=f"cannot be used beside `{first.name.text}`",
        help="use one of them, and declare here what you miss of the other",
        labels=(Label(first.span.place, f"`{first.name.text}` is used here"),),
    )


def unknown_unit(unit: str, span: Span, quantity: str = "") -> Diagnostic:
    refusal = unit_refusal(unit)
    if refusal is not None:
        of_quantity = f" of `{quantity}`" if quantity else ""
        message = f"the unit `{unit}`{of_quantity} cannot be used: {refusal.why}"
        return UNKNOWN_UNIT.at(span, message, help=refusal.instead)
    if unit in ("step", "steps"):
        way_out: Help = (
            "steps count in the bounds of temporal operators only, such as `next[2 steps]`"
        )
    else:
        by_the_clock = how_hours_are_written(span.text)
        of_day = offering(by_the_clock, *hours_meant(span.text)) if by_the_clock else ""
        way_out = of_day or _unit_meant(unit, span)
        number = span.text.removesuffix(unit).strip()
        if not way_out and number and unit.isidentifier():
            way_out = f"for a product write `{number} * {unit}`; units are such as `m`, `km/h`, `s`"
        elif not (way_out or number):
            way_out = (
                "units are such as `m`, `km/h`, `s`, `m/s^2`, `t`, `%`; how many there are of "
                "something, such as passengers, is in `m/m`, which leaves a plain number"
            )
    return UNKNOWN_UNIT.at(
        span,
        f"there is no unit `{unit}`",
        expected="expected a unit of measure",
        help=way_out or "units are such as `m`, `km/h`, `s`, `m/s^2`, `t`, `%`",
    )


def _unit_meant(unit: str, span: Span) -> Help:
    """Help with a unit at the end of a span, if it is one in another language, or misspelt."""
    known, text = unit_in_another_language(unit)
    if not known:
        single, units = unit.removesuffix("s"), known_unit_names()
        known = single if single in units else nearest_name(unit, units) or ""
        text = f"did you mean `{known}`?"
    place = Span(span.source, span.end - len(unit), span.end)
    return offering(text, write(known, place)) if known and place.text == unit else ""


def unknown_dimension(name: tree.Name, known: Sequence[str]) -> Diagnostic:
    synonym = _OTHER_DIMENSIONS.get(name.text.casefold())
    way_out = offering(f"write `{synonym}`", synonym) if synonym else meant(name.text, known)
    return UNKNOWN_DIMENSION.at(
        name.span,
        f"there is no kind of number `{name.text}`",
        expected="expected a kind of number",
        help=way_out or f"known are {named(known)}",
    )
