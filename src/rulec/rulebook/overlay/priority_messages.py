"""Messages about levels of priority."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import line_left_out, offering
from rulec.syntax import tree

PRIORITY_CIRCLE = Code(
    "R0321",
    title="levels of priority form a circle",
    why="With `a > b`, level a is above level b. Equal levels are written `a = b`.",
    bad="rulebook example\npriority safety > legal\n⟪priority legal > safety\n|⟫signal wet\n"
    "hard rule r in legal { require never wet }\n",
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
