"""Levels of priority: a pre-order from the ``priority`` lines of rulebooks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import line_left_out, offering
from rulec.rulebook.arithmetic.size_limits import TOO_LONG
from rulec.syntax import tree

PRIORITY_CIRCLE = Code(
    "R0321",
    title="levels of priority form a circle",
    why="With `a > b`, level a is above level b. Equal levels are written `a = b`.",
    bad="rulebook example\npriority safety > legal\npriority legal > safety\nsignal wet\n"
    "hard rule r in legal { require never wet }\n",
    good="rulebook example\npriority safety > legal\nsignal wet\n"
    "hard rule r in legal { require never wet }\n",
)


MOST_LEVELS = 100
"""The most levels; more would be incomprehensible."""


def pre_order(
    lines: Sequence[tree.PriorityLine],
) -> tuple[tuple[str, ...], frozenset[tuple[str, str]], list[Diagnostic]]:
    """Levels in order of first mention, their pre-order, and the mistakes.

    The pre-order consists of all pairs (higher, lower) and is transitive; equal levels are paired
    in both orders. A line that contradicts earlier ones is reported and ignored.
    """
    levels: dict[str, tree.Name] = {}
    order: set[tuple[str, str]] = set()
    strict: set[tuple[str, str]] = set()
    mistakes: list[Diagnostic] = []
    for line in lines:
        if len({*levels, *(name.text for name in line.levels)}) > MOST_LEVELS:
            wrong = TOO_LONG.at(
                line.span,
                f"there are more than {MOST_LEVELS} levels of priority",
                help="use fewer levels, and weights among the rules of one level",
            )
            mistakes.append(wrong)
            break
        for (higher, lower), sign in zip(pairwise(line.levels), line.relations, strict=True):
            above, below = higher.text, lower.text
            larger, demanded = _with_pair(order, (above, below)), strict
            if sign == ">":
                demanded = strict | {(above, below)}
            else:
                larger = _with_pair(larger, (below, above))
            if any(pair[::-1] in larger for pair in demanded) or (above == below and sign == ">"):
                mistakes.append(_priority_circle(higher, lower, sign, levels))
                continue
            order, strict = larger, demanded
        for name in line.levels:
            levels.setdefault(name.text, name)
    return tuple(levels), frozenset(order), mistakes


def _with_pair(order: set[tuple[str, str]], pair: tuple[str, str]) -> set[tuple[str, str]]:
    """The transitive closure of an order and one more pair, without reflexive pairs."""
    higher, lower = pair
    above = [higher, *(level for level, other in order if other == higher)]
    below = [lower, *(level for other, level in order if other == lower)]
    return order | {pair for pair in product(above, below) if pair[0] != pair[1]}


def _priority_circle(
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
