"""What is said about declarations that are wrong."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, Span, nearest_name
from rulec.syntax import tree


def unknown_type(name: tree.Name, known: Sequence[str]) -> Diagnostic:
    """No type of that name."""
    near = nearest_name(name.text, known)
    if near is not None:
        way_out = f"did you mean `{near}`?"
    elif known:
        way_out = f"known are {_listed(known)}; declare another by `type {name.text}`"
    else:
        way_out = f"declare it by `type {name.text}`, or `use` a vocabulary that has types"
    return Diagnostic(
        "R0201",
        f"there is no type `{name.text}`",
        name.span.place,
        expected="expected a type",
        help=way_out,
    )


def _listed(names: Sequence[str]) -> str:
    shown = [f"`{name}`" for name in names[:8]]
    return ", ".join([*shown, "…"] if len(names) > len(shown) else shown)


def which_type(parameter: tree.Parameter, roots: Sequence[str]) -> Diagnostic:
    """A parameter without a type, where there is more than one possibility or none."""
    why = f"{_listed(roots)} are all possible" if roots else "no type is declared"
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
    near = nearest_name(chosen.text, values)
    return Diagnostic(
        "R0305",
        f"`{chosen.text}` is not a value of `{name.text}`",
        chosen.span.place,
        expected="expected one of its values",
        help=f"did you mean `{near}`?" if near else f"its values are {_listed(values)}",
    )


def twice(what: str, again: tree.Name, first: Span) -> Diagnostic:
    """A type, a name or a parameter declared a second time."""
    advice = "; values are names too" if what == "name" else ""
    return Diagnostic(
        "R0204",
        f"the {what} `{again.text}` is declared twice",
        again.span.place,
        expected="declared again here",
        help=f"rename one of the two{advice}",
        labels=(Label(first.place, "first declared here"),),
    )
