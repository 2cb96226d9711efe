"""Messages about rulebooks that build upon others."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from rulec.diagnostics import Diagnostic, Fix, Label, Offer, Span, named
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import (
    Help,
    another_name,
    left_out,
    line_left_out,
    meant,
    offering,
    write,
)
from rulec.rulebook.names.atom_messages import NUMBER_OR_FORMULA, UNKNOWN_VARIABLE, WRONG_ARITY
from rulec.rulebook.names.declaration_messages import DECLARED_TWICE
from rulec.rulebook.rulebook_model import Remark
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import (
    declaration_left_out,
    exchanged,
    member_left_out,
)
from rulec.syntax.tree_printer import print_parameter, print_parameters

RULE_TWICE = Code("R0205")

NOT_INHERITED = Code("R0212")

LOST_EXCEPTION = Code("R0260")

IDLE_OVERRIDE = Code("R0261")

OTHER_TYPES = Code("R0262")

INHERITED_ALREADY = Code("R0214")


NEVER_IN_FORCE = Code("R0324")


_CHANGES = {"option": "set", "parameter": "set", "definition": "redefine"}


def inherited_name(name: tree.Name, kind: str, known: tree.Name) -> Diagnostic:
    changes = f"{_CHANGES[kind]} {name.text}"
    return INHERITED_ALREADY.at(
        name.span,
        f"`{name.text}` is inherited already",
        expected="declared again here",
        help=offering(
            f"change an inherited {kind} by `{changes} = …`", *_changing(name.span, changes)
        ),
        labels=(Label(known.span.place, "inherited from here"),),
    )


def _changing(name: Span, head: str) -> Iterator[Offer]:
    """A change of an inherited symbol in place of its declaration, up to the `=` of that line."""
    text, start = name.source.text, name.start
    line = text.find("\n", start)
    equals = text.find("=", start, len(text) if line < 0 else line)
    if equals >= 0:
        whole = Span(name.source, text.rfind("\n", 0, start) + 1, equals)
        yield Offer(f"Write `{head} = …`", (Fix(whole.place, f"{head} "),))


def inherited_rule(item: tree.RuleItem, known: tree.RuleItem) -> Diagnostic:
    name, change = item.name.span, f"override rule {item.name.text}"
    head = Span(name.source, item.span.start, name.end)
    return INHERITED_ALREADY.at(
        item.name.span,
        f"a rule `{item.name.text}` is inherited already",
        expected="named again here",
        help=offering(
            f"write `{change}` to change it, or choose another name",
            write(change, head),
            another_name(name),
        ),
        labels=(Label(known.name.span.place, "inherited from here"),),
    )


def rule_twice(again: tree.RuleItem, first: tree.RuleItem) -> Diagnostic:
    return RULE_TWICE.at(
        again.name.span,
        f"there are two rules `{again.name.text}`",
        expected="named again here",
        help=offering("give each rule a name of its own", another_name(again.name.span)),
        labels=(Label(first.name.span.place, "first named here"),),
    )


_ALIKE: Final = 0.75
"""The least similarity of misspelt rule names, which often share parts.

Thus `queue_weaving` is not a misspelt `bus_leaving`.
"""


def nothing_to(
    verb: str, kind: str, name: tree.Name, known: Sequence[str], extends: str | None
) -> Diagnostic:
    """``override``, ``drop``, … of what is not inherited."""
    if extends is None:
        way_out: Help = "the rulebook extends no other; name one in its header by `extends NAME`"
    else:
        has = f"`{extends}` has {named(known) or 'none'}"
        way_out = meant(name.text, known, _ALIKE) or has
    return NOT_INHERITED.at(
        name.span,
        f"there is no {kind} `{name.text}` to {verb}",
        expected=f"expected an inherited {kind}",
        help=way_out,
    )


def gone_before(name: tree.Name, verb: str, remark: Remark, before: tree.Name) -> Diagnostic:
    """``override``, ``drop``, … of a rule that a base has dropped or is silent on."""
    has = "is silent on it" if remark.kind == "silent" else "dropped it"
    way_out: Help = "leave the line out: it is so already"
    if verb in ("override", "confirm"):
        way_out = f"write a rule of this rulebook's own: `hard rule {name.text}`"
    return NOT_INHERITED.at(
        name.span,
        f"there is no rule `{name.text}` to {verb}: `{remark.book}` {has}",
        expected="expected an inherited rule",
        help=way_out,
        labels=(Label(before.span.place, "here"),),
    )


def not_inherited(name: tree.Name, kind: str, verb: str, known: tree.Name) -> Diagnostic:
    """A change to something of the same rulebook, such as by ``set`` or ``override``."""
    article = "an" if kind == "option" else "a"
    return NOT_INHERITED.at(
        name.span,
        f"`{name.text}` is {article} {kind} of this rulebook, not an inherited one to {verb}",
        expected=f"expected an inherited {kind}",
        help=f"change the {kind} itself",
        labels=(Label(known.span.place, f"the {kind} is here"),),
    )


def changed_twice(name: tree.Name, kind: str, before: tree.Name) -> Diagnostic:
    return DECLARED_TWICE.at(
        name.span,
        f"the {kind} `{name.text}` is changed twice in this rulebook",
        expected="changed again here",
        help="say all of it in one place",
        labels=(Label(before.span.place, "first changed here"),),
    )


def other_parameters(item: tree.DefineItem, before: tree.DefineItem) -> Diagnostic:
    name = item.name.text
    needed, given = len(before.parameters), len(item.parameters)
    things = {0: "nothing", 1: "one thing"}
    return WRONG_ARITY.at(
        item.name.span,
        f"`{name}` takes {things.get(needed, f'{needed} things')} where it comes from, "
        f"and {things.get(given, f'{given} things')} here",
        expected=f"expected `{name}{print_parameters(before.parameters)}`",
        help=offering(
            "redefine it with the same parameters, or define something new by another name",
            another_name(item.name.span),
        ),
        labels=(Label(before.name.span.place, f"`{name}` is defined here"),),
    )


def lost_variables(item: tree.RuleItem, lost: Sequence[tree.Parameter]) -> Diagnostic:
    names = " and ".join(f"`{variable.name.text}`" for variable in lost)
    first = item.variables[0].span
    return UNKNOWN_VARIABLE.at(
        Span(first.source, first.start, item.variables[-1].span.end),
        f"what `{item.name.text}` inherits speaks of {names}, and here is no such variable",
        expected=f"expected {names}",
        help="call variables as they are called there, or write every clause and example anew",
        labels=tuple(
            Label(variable.span.place, f"`{variable.name.text}` comes from here")
            for variable in lost
        ),
    )


def never_in_force(dates: tree.InForce) -> Diagnostic:
    """``in force from 2024-01-01 until 2020-01-01``."""
    return NEVER_IN_FORCE.at(
        dates.span,
        f"this is never in force: {dates.until} comes before {dates.since}",
        expected="expected the earlier day first",
        help=offering(
            "exchange the days, or correct one of them",
            *exchanged(dates.span, str(dates.since), str(dates.until)),
        ),
    )


def value_of_another_kind(item: tree.SetItem) -> Diagnostic:
    name = item.name.text
    if isinstance(item.value, bool):
        kind, expected = "a parameter, which is a number", "a number"
        way_out = "only an option is on or off"
    else:
        kind, expected = "an option, which is on or off", "`on` or `off`"
        way_out = f"write `set {name} = on` or `set {name} = off`"
    return NUMBER_OR_FORMULA.at(
        item.span, f"`{name}` is {kind}", expected=f"expected {expected}", help=way_out
    )


def soft_already(item: tree.SoftenItem, known: tree.RuleItem) -> Diagnostic:
    """``soften`` of a soft rule, without a new level or weight."""
    return NOT_INHERITED.at(
        item.name.span,
        f"rule `{item.name.text}` is soft already",
        expected="nothing changes",
        help=offering("leave the line out", *declaration_left_out(item.name.span)),
        labels=(Label(known.name.span.place, "inherited from here"),),
    )


def idle_override(item: tree.RuleItem) -> Diagnostic:
    """An override that changes nothing."""
    name = item.name.text
    is_one_line = re.fullmatch(r"[^\n{]*\{\s*\}", item.span.text) is not None
    return IDLE_OVERRIDE.at(
        item.name.span,
        f"this override of `{name}` changes nothing",
        expected="all of it is as it is inherited",
        help=offering(
            "say what is different; where it is law as it is, write "
            f'`confirm rule {name} {{ cite "…" }}`; or leave it out',
            *(line_left_out(item.name.span, "override") if is_one_line else ()),
        ),
        severity="warning",
    )


def other_types(
    item: tree.RuleItem, changed: Sequence[tuple[tree.Parameter, tree.Parameter]]
) -> Diagnostic:
    """An override with variables of other types than the inherited ones, each with both."""
    now = [print_parameter(after) for _, after in changed]
    before = [print_parameter(known) for known, _ in changed]
    return OTHER_TYPES.at(
        changed[0][1].span,
        f"`{item.name.text}` is about {named(now)} here, and was about {named(before)}",
        expected="another type",
        help=offering(
            f"leave the variables out to keep {named(before)}; or say what the rule is now",
            *member_left_out(changed[0][1].span),
        ),
        labels=tuple(Label(known.span.place, "inherited from here") for known, _ in changed),
        severity="warning",
    )


def lost_exceptions(item: tree.RuleItem, gone: Sequence[tree.Unless]) -> Diagnostic:
    """An override whose ``unless`` replaces inherited exceptions."""
    plain = [exception for exception in item.unless if not exception.also]
    first = plain[0].span
    texts = named([" ".join(unless.span.text.removeprefix("also").split()) for unless in gone])
    exceptions = "the inherited exception" if len(gone) == 1 else "the inherited exceptions"
    return LOST_EXCEPTION.at(
        Span(first.source, first.start, first.start + len("unless")),
        f"`{item.name.text}` loses {exceptions} {texts}",
        expected="this replaces what is inherited",
        help="write `also unless` to add to it, or repeat what stays; or say what the rule is now",
        labels=tuple(Label(unless.span.place, "lost here") for unless in gone),
        severity="warning",
        fix=_added(plain),
    )


def _added(plain: Sequence[tree.Unless]) -> Fix | None:
    """The fix, if adding one word suffices."""
    span = plain[0].span
    return (
        Fix(Span(span.source, span.start, span.start).place, "also ") if len(plain) == 1 else None
    )


def nothing_to_add_to(exception: tree.Unless) -> Diagnostic:
    """``also unless`` in a rule that overrides nothing."""
    start = exception.span.start
    also = Span(exception.span.source, start, start + len("also"))
    behind = exception.span.text.removeprefix("also")
    space = len(behind) - len(behind.lstrip())
    also_and_space = Span(also.source, start, also.end + space)
    return NOT_INHERITED.at(
        also,
        "`also unless` adds to inherited exceptions, and this rule inherits none",
        expected="expected `unless`",
        help=offering(
            "write `unless`, or `override rule` before the name of an inherited rule",
            left_out(also_and_space, "Leave out `also`"),
        ),
    )
