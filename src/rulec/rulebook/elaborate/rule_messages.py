"""Messages about rules and definitions as a whole."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import perm

from rulec.diagnostics import Diagnostic, Label, Offer, Span, named
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, meant, offering, write
from rulec.logic.bounds import longest_divisor
from rulec.logic.printing import time_in_words
from rulec.resource_limits import CHOICES
from rulec.rulebook.arithmetic.size_limits import DEEPEST, MOST_PARTS, Limit
from rulec.rulebook.arithmetic.size_messages import FORMULA_TOO_LARGE
from rulec.rulebook.rulebook_model import Rule
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import declaration_left_out, member_left_out, with_scope
from rulec.syntax.messages.mismatch import FORMULA_TOO_DEEP

CROWD = 30
"""The number of objects around in dense traffic."""

UNUSED_VARIABLE = Code("R0207")

EXCEPTION_BEHIND_ANOTHER = Code("R0364")

UNUSED_CONSTANT = Code("R0208")

MANY_CHOICES = Code("R0326")

UNKNOWN_PRIORITY = Code("R0215")

UNFITTING_SCOPE = Code("R0318")

NOT_ABOVE_ZERO = Code("R0322")

NOT_A_MULTIPLE = Code("R0407")


def over_limit(limit: Limit, part: str, name: tree.Name) -> Diagnostic:
    subject = f"the {part}{' of' if part == 'formula' else ''} `{name.text}`"
    if limit == "deep":
        return FORMULA_TOO_DEEP.at(
            name.span,
            f"{subject} is nested more than {DEEPEST} levels deep, with definitions put in",
            help="write its parts as separate rules",
        )
    return FORMULA_TOO_LARGE.at(
        name.span,
        f"{subject} has more than {MOST_PARTS:,} parts, with definitions put in",
        help="definitions that use another one twice double it each time: make them simpler",
    )


def no_level(level: tree.Name, known: Sequence[str]) -> Diagnostic:
    """A rule at a level that no ``priority`` line names."""
    if known:
        way_out = meant(level.text, known) or f"known are {named(known)}"
    else:
        lower = level.text if level.text != "safety" else "courtesy"
        way_out = f"name it in the header, such as `priority safety > {lower}`"
    return UNKNOWN_PRIORITY.at(
        level.span,
        f"there is no level of priority `{level.text}`",
        expected="expected a level of a `priority` line",
        help=way_out,
    )


def misfit(changed: tree.Name, first: Diagnostic) -> Diagnostic:
    return replace(
        first,
        message=f"the examples that `{changed.text}` inherits do not fit it any more: "
        f"{first.message}",
        place=changed.span.place,
        expected="the rule is changed here",
        help="give it examples of its own, by `accept { … }` and `reject { … }`",
        labels=() if first.place is None else (Label(first.place, "an inherited example"),),
    )


def weightless(weight: tree.NumberLiteral) -> Diagnostic:
    return NOT_ABOVE_ZERO.at(
        weight.span,
        f"a weight of {weight.text} says that the rule does not count",
        expected="expected a number above 0",
        help=offering("leave the rule out, or give it a weight", "1"),
    )


def no_step(line: tree.StepLine) -> Diagnostic:
    return NOT_ABOVE_ZERO.at(
        line.amount.span,
        "the step is no time above 0",
        expected="expected a time",
        help="write a time, such as `step 0.5 s`",
    )


def unused_variable(
    variable: tree.Parameter, owner: tree.RuleItem | tree.DefineItem | tree.Aggregate
) -> Diagnostic:
    alone = member_left_out(variable.span)
    match owner:
        case tree.RuleItem(name=name):
            part, where = f"formula of `{name.text}`", "in `require`"
            way_out: Help = offering("leave the variable out, or speak of it", *alone)
        case tree.DefineItem(name=name):
            part, where = f"definition of `{name.text}`", "after `=`"
            way_out = offering("leave it out, or speak of it", *alone)
        case _:
            part, where = "formula", "after it"
            way_out = "speak of it, or leave the variable out"
    return UNUSED_VARIABLE.at(
        variable.span,
        f"the {part} says nothing about `{variable.name.text}`",
        expected=f"not used {where}",
        help=way_out,
        severity="warning",
    )


def many_choices(item: tree.RuleItem, n_variables: int) -> Diagnostic | None:
    """A warning if a crowd of objects has more choices than rulec usually tries."""
    number = perm(CROWD, n_variables)
    if number <= CHOICES.usual:
        return None
    return MANY_CHOICES.at(
        item.name.span,
        f"rule `{item.name.text}` has {number:,} choices of {CROWD} objects for its "
        f"{n_variables} variables",
        expected=f"at most {CHOICES.usual:,} are looked at, unless --limit says otherwise",
        help="give it fewer variables, or count objects with `some`, `every` or `count`",
        severity="warning",
    )


def unused_provision(kind: str, name: tree.Name) -> Diagnostic:
    return UNUSED_CONSTANT.at(
        name.span,
        f"no rule uses the {kind} `{name.text}`",
        expected="not used",
        help=offering("leave it out, or speak of it in a rule", *declaration_left_out(name.span)),
        severity="warning",
    )


def unfitting_exception(problem: str, item: tree.RuleItem, *, first_state_only: bool) -> Diagnostic:
    required = () if item.require is None else (item.require.span.place,)
    labels = tuple(Label(place, "this is what the rule requires") for place in required)
    if problem == "no stretch":
        unless = next(unless for unless in item.unless if unless.scope != "initially")
        around = "" if item.require is None else _around_all(item.require)
        written = f"`{unless.scope}`" if unless.scope else "this exception"
        return UNFITTING_SCOPE.at(
            unless.span,
            f"{written} cannot be used here: it takes out a part of the time that a rule is about, "
            "and only rules that begin with `never` or `always` are about such a time",
            expected="expected a rule that begins with `never` or `always`"
            if first_state_only
            else "expected `initially` after it",
            help=around
            or offering(
                "write `require always (…)`, since this asks for something in the first state "
                "only; or `initially` at the end of the exception, if that is meant"
                if first_state_only
                else "write `initially` at its end, if the first state decides; or begin the rule "
                "with `never` or `always`; or write two rules, one for when the exception holds "
                "and one for when it does not",
                *with_scope(unless.span, "initially"),
            ),
            labels=labels,
        )
    unless = [unless for unless in item.unless if unless.scope in (None, "throughout")][-1]
    return UNFITTING_SCOPE.at(
        unless.span,
        "an exception cannot hold `throughout` where `then` has a bound, such as `[<= 2 s]`",
        expected="expected `at start`, `at end` or `at some point` after it",
        help=offering(
            "write `at start`, `at end` or `at some point` behind it, whichever is meant; or "
            "leave the bounds of `then` out; or write two rules, one with the exception and "
            "one with the bounds",
            *with_scope(unless.span, "at start", "at end", "at some point"),
        ),
        labels=labels,
    )


def _around_all(required: tree.Formula) -> str:
    """Help if what is required begins with `always`, which is about its first part only."""
    node = required
    while isinstance(node, tree.Infix) and (node is required or not node.grouped):
        node = node.left
    if isinstance(node, tree.Prefix) and node is not required:
        assert isinstance(required, tree.Infix), "its first part is another node"
        if node.operator == "always" or (node.operator == "never" and required.operator == "and"):
            return (
                f"write `{node.operator} (… {required.operator} …)`: without parentheses "
                f"`{node.operator}` is about its first part only"
            )
    return ""


def no_multiple(rule: Rule, offending: Fraction, span: Span | None) -> Diagnostic:
    """A warning (R0407): at the rulebook's own step, a bound (s) falls between two states."""
    below = offending // rule.step_s * rule.step_s
    nearest = [time_in_words(time, "s") for time in (below, below + rule.step_s) if time]
    bound, was = span or rule.span, time_in_words(offending, "s")
    # With another number it is another law, except for one that is about the same.
    close = [time for time in (below, below + rule.step_s) if _is_close(time, offending)]
    fitting = time_in_words(longest_divisor((offending, rule.step_s)), "s")
    are = "multiples are" if len(nearest) > 1 else "multiple is"
    return NOT_A_MULTIPLE.at(
        bound,
        f"`{was}` is not a multiple of the step, {time_in_words(rule.step_s, 's')}",
        help=offering(
            f"the nearest {are} {' and '.join(nearest)}; or write `step {fitting}` in the header",
            *_other_times(bound, was, [time_in_words(time, "s") for time in close]),
        ),
        notes=(f"the examples of rule `{rule.name}` have no state at that moment",),
        severity="warning",
    )


def _is_close(time: Fraction, wanted: Fraction) -> bool:
    return abs(time - wanted) * 20 <= wanted


def _other_times(bound: Span | None, was: str, times: Iterable[str]) -> Iterator[Offer]:
    """Other times in a bound, in which one is written as given."""
    head, found, _ = bound.text.partition(was) if bound else ("", "", "")
    if bound and found:
        start = bound.start + len(head)
        place = Span(bound.source, start, start + len(was))
        yield from (write(time, place) for time in times)


def exceptions_on_one_line(item: tree.RuleItem) -> Iterator[Diagnostic]:
    """A warning for each exception that begins on the line on which another one ends."""
    for first, second in pairwise(item.unless):
        before, here = first.span.place, second.span.place
        same_line = (before.file, before.end_line) == (here.file, here.line)
        if same_line and not second.also:
            yield EXCEPTION_BEHIND_ANOTHER.at(
                second.span,
                "this exempts besides the exception before it, and takes nothing from it",
                expected="another exception of the whole rule",
                help="for an exception of the exception write `unless p and not q`; where either "
                "exempts, begin a new line",
                labels=(Label(before, "this exempts by itself"),),
                severity="warning",
            )
