"""What is said about rules and definitions as a whole."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, did_you_mean, named
from rulec.rulebook.elaborate.size_limits import DEEPEST, MOST_PARTS
from rulec.syntax import tree


def too_deep(what: str, name: tree.Name) -> Diagnostic:
    """A formula, definition or parameter that is too deep once definitions are put in."""
    return Diagnostic(
        "R0111",
        f"the {what}{_of(what)} `{name.text}` is nested more than {DEEPEST} levels deep, with "
        "definitions put in",
        name.span.place,
        help="say its parts in rules of their own",
    )


def too_large(what: str, name: tree.Name) -> Diagnostic:
    """One that is too large once definitions are put in."""
    return Diagnostic(
        "R0323",
        f"the {what}{_of(what)} `{name.text}` has more than {MOST_PARTS:,} parts, with definitions "
        "put in",
        name.span.place,
        help="definitions that use another one twice double it each time: make them simpler",
    )


def _of(what: str) -> str:
    return " of" if what == "formula" else ""


def no_level(level: tree.Name, known: Sequence[str]) -> Diagnostic:
    """A rule at a level that no ``priority`` line names."""
    if known:
        way_out = did_you_mean(level.text, known) or f"known are {named(known)}"
    else:
        lower = level.text if level.text != "safety" else "courtesy"
        way_out = f"name it in the header, such as `priority safety > {lower}`"
    return Diagnostic(
        "R0215",
        f"there is no level of priority `{level.text}`",
        level.span.place,
        expected="expected a level of a `priority` line",
        help=way_out,
    )


def misfit(changed: tree.Name, first: Diagnostic) -> Diagnostic:
    """Inherited examples that do not fit the rule any more as it has been changed."""
    return Diagnostic(
        first.code,
        f"the examples that `{changed.text}` inherits do not fit it any more: {first.message}",
        changed.span.place,
        expected="the rule is changed here",
        help="give it examples of its own, by `accept { … }` and `reject { … }`",
        labels=() if first.place is None else (Label(first.place, "an inherited example"),),
    )


def weightless(weight: tree.Number) -> Diagnostic:
    """A weight of 0."""
    return Diagnostic(
        "R0322",
        f"a weight of {weight.text} says that the rule does not count",
        weight.span.place,
        expected="expected a number above 0",
        help="leave the rule out, or give it a weight",
    )


def no_step(line: tree.StepLine) -> Diagnostic:
    """A step that is no time above 0."""
    return Diagnostic(
        "R0322",
        "the step is no time above 0",
        line.amount.span.place,
        expected="expected a time",
        help="write a time, such as `step 0.5 s`",
    )


def unused_parameter(item: tree.DefineItem, parameter: tree.Parameter) -> Diagnostic:
    """A definition's parameter that its body says nothing about."""
    return Diagnostic(
        "R0207",
        f"the definition of `{item.name.text}` says nothing about `{parameter.name.text}`",
        parameter.span.place,
        expected="not used behind `=`",
        help="leave it out, or speak of it",
        severity="warning",
    )


def unused_provision(kind: str, name: tree.Name) -> Diagnostic:
    """An option, a parameter or a definition that nothing uses."""
    return Diagnostic(
        "R0208",
        f"no rule uses the {kind} `{name.text}`",
        name.span.place,
        expected="not used",
        help="leave it out, or speak of it in a rule",
        severity="warning",
    )
