"""Levels of priority: a pre-order from the ``priority`` lines of rulebooks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product

from rulec.diagnostics import Diagnostic
from rulec.rulebook.arithmetic.size_messages import TOO_LONG
from rulec.rulebook.overlay.topic_messages import priority_circle
from rulec.syntax import tree

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
                mistakes.append(priority_circle(higher, lower, sign, levels))
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
