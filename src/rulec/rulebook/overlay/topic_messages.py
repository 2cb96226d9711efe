"""Messages about topics, listed articles and levels of priority."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, named
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, line_left_out, meant, offering
from rulec.rulebook.names.declaration_messages import DECLARED_TWICE
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import clause_left_out

PRIORITY_CIRCLE = Code("R0321")


UNKNOWN_TOPIC = Code("R0217")


def no_topic(name: tree.Name, known: Sequence[str], of_rule: Sequence[str]) -> Diagnostic:
    """A topic that is not declared; ``of_rule`` are those of a rule of that name."""
    rules: Help = ""
    if of_rule:
        rules = offering(f"a rule of that name is about the topic `{of_rule[0]}`", of_rule[0])
    has = f"the topics are {named(known)}" if known else 'declare it: `topics { NAME "title" }`'
    return UNKNOWN_TOPIC.at(
        name.span,
        f"there is no topic `{name.text}`",
        expected="expected a topic",
        help=rules or meant(name.text, known) or has,
    )


def article_twice(again: tree.Text, first: tree.Text) -> Diagnostic:
    return DECLARED_TWICE.at(
        again.span,
        f"article `{again.value}` is listed twice in this rulebook",
        expected="listed again here",
        help=offering("keep one of them", clause_left_out(again.span)),
        labels=(Label(first.span.place, "first listed here"),),
    )


def priority_circle(
    higher: tree.Name, lower: tree.Name, sign: str, levels: dict[str, tree.Name]
) -> Diagnostic:
    placed = dict.fromkeys(name.text for name in (higher, lower) if name.text in levels)
    same = higher.text == lower.text
    against = "itself" if same else "the order so far"
    return PRIORITY_CIRCLE.at(
        lower.span,
        f"`{higher.text} {sign} {lower.text}` contradicts {against}",
        expected="a level compared with itself" if same else "this closes a circle",
        help=offering(
            "leave one of the lines out; levels of one rank are written `a = b`",
            *line_left_out(lower.span, "priority"),
        ),
        labels=tuple(
            Label(levels[name].span.place, f"`{name}` was placed here") for name in placed
        ),
    )
