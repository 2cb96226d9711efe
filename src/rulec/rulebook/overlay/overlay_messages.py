"""What is said about rulebooks that build upon others."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, Span, did_you_mean, named
from rulec.rulebook.names.declaration_messages import twice
from rulec.syntax import tree
from rulec.syntax.printer import print_parameters

__all__ = [
    "changed_twice",
    "inherited_name",
    "inherited_rule",
    "lost_variables",
    "never_in_force",
    "nothing_to",
    "option_is_on_or_off",
    "other_parameters",
    "own",
    "own_rule",
    "parameter_is_a_number",
    "rule_twice",
    "soft_already",
    "twice",
]

_CHANGES = {"option": "set", "parameter": "set", "definition": "redefine"}


def inherited_name(name: tree.Name, kind: str, known: tree.Name) -> Diagnostic:
    """An option, parameter or definition that the rulebook inherits already."""
    return Diagnostic(
        "R0214",
        f"`{name.text}` is inherited already",
        name.span.place,
        expected="declared again here",
        help=f"change an inherited {kind} by `{_CHANGES[kind]} {name.text} = …`",
        labels=(Label(known.span.place, "inherited from here"),),
    )


def inherited_rule(item: tree.RuleItem, known: tree.RuleItem) -> Diagnostic:
    """A rule by the name of an inherited one."""
    return Diagnostic(
        "R0214",
        f"a rule `{item.name.text}` is inherited already",
        item.name.span.place,
        expected="named again here",
        help=f"write `override rule {item.name.text}` to change it, or choose another name",
        labels=(Label(known.name.span.place, "inherited from here"),),
    )


def rule_twice(again: tree.RuleItem, first: tree.RuleItem) -> Diagnostic:
    """Two rules of one name in one rulebook."""
    return Diagnostic(
        "R0205",
        f"there are two rules `{again.name.text}`",
        again.name.span.place,
        expected="named again here",
        help="give each rule a name of its own",
        labels=(Label(first.name.span.place, "first named here"),),
    )


def nothing_to(
    verb: str, kind: str, name: tree.Name, known: Sequence[str], extends: str | None
) -> Diagnostic:
    """``override``, ``drop``, … of what is not inherited."""
    if extends is None:
        way_out = "the rulebook extends no other; name one in its header by `extends NAME`"
    else:
        listed = f"`{extends}` has {named(known)}" if known else f"`{extends}` has none"
        way_out = did_you_mean(name.text, known) or listed
    return Diagnostic(
        "R0212",
        f"there is no {kind} `{name.text}` to {verb}",
        name.span.place,
        expected=f"expected an inherited {kind}",
        help=way_out,
    )


def own_rule(name: tree.Name, verb: str, known: tree.RuleItem) -> Diagnostic:
    """``override``, ``drop``, ``soften`` of a rule of the same rulebook."""
    return Diagnostic(
        "R0212",
        f"`{name.text}` is a rule of this rulebook, not an inherited one to {verb}",
        name.span.place,
        expected="expected an inherited rule",
        help="change the rule itself",
        labels=(Label(known.name.span.place, "the rule is here"),),
    )


def own(name: tree.Name, kind: str, verb: str, known: tree.Name) -> Diagnostic:
    """``set`` or ``redefine`` of something of the same rulebook."""
    article = "an" if kind == "option" else "a"
    return Diagnostic(
        "R0212",
        f"`{name.text}` is {article} {kind} of this rulebook, not an inherited one to {verb}",
        name.span.place,
        expected=f"expected an inherited {kind}",
        help=f"change the {kind} itself",
        labels=(Label(known.span.place, f"the {kind} is here"),),
    )


def changed_twice(name: tree.Name, kind: str, before: tree.Name) -> Diagnostic:
    """A second line that changes the same thing in one rulebook."""
    return Diagnostic(
        "R0204",
        f"the {kind} `{name.text}` is changed twice in this rulebook",
        name.span.place,
        expected="changed again here",
        help="say all of it in one place",
        labels=(Label(before.span.place, "first changed here"),),
    )


def other_parameters(item: tree.DefineItem, before: tree.DefineItem) -> Diagnostic:
    """A definition that is given another meaning for more or fewer things."""
    name = item.name.text
    needed, given = len(before.parameters), len(item.parameters)
    things = {0: "nothing", 1: "one thing"}
    return Diagnostic(
        "R0301",
        f"`{name}` takes {things.get(needed, f'{needed} things')} where it comes from, "
        f"and {things.get(given, f'{given} things')} here",
        item.name.span.place,
        expected=f"expected `{name}{print_parameters(before.parameters)}`",
        help="redefine it with the same parameters, or define something new by another name",
        labels=(Label(before.name.span.place, f"`{name}` is defined here"),),
    )


def lost_variables(item: tree.RuleItem, lost: Sequence[tree.Parameter]) -> Diagnostic:
    """An override without variables that the clauses which it inherits speak of."""
    names = " and ".join(f"`{one.name.text}`" for one in lost)
    first, last = item.variables[0].span, item.variables[-1].span
    return Diagnostic(
        "R0203",
        f"what `{item.name.text}` inherits speaks of {names}, and here is no such variable",
        Span(first.source, first.start, last.end).place,
        expected=f"expected {names}",
        help="call variables as they are called there, or write every clause and example anew",
        labels=tuple(Label(one.span.place, f"`{one.name.text}` comes from here") for one in lost),
    )


def never_in_force(dates: tree.InForce) -> Diagnostic:
    """``in force from 2024-01-01 until 2020-01-01``."""
    return Diagnostic(
        "R0324",
        f"this is never in force: {dates.until} comes before {dates.since}",
        dates.span.place,
        expected="expected the earlier day first",
        help="exchange the days, or correct one of them",
    )


def option_is_on_or_off(item: tree.SetItem) -> Diagnostic:
    """An option set to something else."""
    return Diagnostic(
        "R0313",
        f"`{item.name.text}` is an option, which is on or off",
        item.span.place,
        expected="expected `on` or `off`",
        help=f"write `set {item.name.text} = on` or `set {item.name.text} = off`",
    )


def parameter_is_a_number(item: tree.SetItem) -> Diagnostic:
    """A parameter set to on or off."""
    return Diagnostic(
        "R0313",
        f"`{item.name.text}` is a parameter, which is a number",
        item.span.place,
        expected="expected a number",
        help="only an option is on or off",
    )


def soft_already(item: tree.SoftenItem, known: tree.RuleItem) -> Diagnostic:
    """``soften`` of a soft rule, without a new place or weight."""
    return Diagnostic(
        "R0212",
        f"rule `{item.name.text}` is soft already",
        item.name.span.place,
        expected="nothing changes",
        help="leave the line out",
        labels=(Label(known.name.span.place, "inherited from here"),),
    )
