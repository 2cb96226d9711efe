"""What is said about rulebooks that build upon others."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, did_you_mean, named
from rulec.rulebook.declaration_messages import twice
from rulec.syntax import tree

__all__ = [
    "inherited_name",
    "inherited_rule",
    "nothing_to",
    "option_is_on_or_off",
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
