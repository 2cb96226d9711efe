"""Fold large explanations to the parts that decide and the states that fit.

An explanation is folded if its table has too many parts or is too wide; each independently.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.logic.bounds import BOOLEAN, operations_of
from rulec.logic.formula import Binary, BinaryOperator, Unary, UnaryOperator
from rulec.monitoring.explain.explained_parts import Part

MOST_PARTS = 20
"""Of a formula with more parts, only those that decide are shown."""

LEAST = 24
"""Number of characters of a part that are shown at least, however deep it is nested."""

_CHAINED = (BinaryOperator.AND, BinaryOperator.OR)

Titled = tuple[str, Part]
"""A part's text, indented and cut, and the part."""


def titled(parts: Sequence[Part], widest: int) -> list[Titled]:
    """All parts, with their texts cut to a number of characters."""
    return [("  " * part.depth + clipped(part.text, widest), part) for part in parts]


def folded(parts: Sequence[Part], widest: int) -> list[Titled]:
    """The parts that decide, with their texts cut to a number of characters.

    The operands of a part about a single state are omitted, because the facts show them. The
    operands of nested `and`, or of nested `or`, are on one level.
    """
    return list(_folded(parts, 0, 0, widest))


def _folded(parts: Sequence[Part], at: int, depth: int, widest: int) -> Iterator[Titled]:
    part = parts[at]
    text = clipped(part.text, max(widest - 2 * depth, LEAST))
    yield "  " * depth + text, part
    now = all(operation.operator in BOOLEAN for operation in operations_of(part.formula))
    if now:
        return
    for operand in _operands(parts, at):
        yield from _folded(parts, operand, depth + 1, widest)


def clipped(text: str, widest: int) -> str:
    """A text, cut to a number of characters."""
    return text if len(text) <= widest else f"{text[: widest - 1]}…"


def _operands(parts: Sequence[Part], at: int) -> Iterator[int]:
    for operand in range(at + 1, len(parts)):
        if parts[operand].depth <= parts[at].depth:
            return
        if parts[operand].depth > parts[at].depth + 1 or not parts[operand].decides:
            continue
        if _is_link(parts[at], parts[operand]):
            yield from _operands(parts, operand)
        else:
            yield operand


def _is_link(part: Part, operand: Part) -> bool:
    match part.formula, operand.formula:
        case Binary(operator), Binary(inner):
            return operator is inner and operator in _CHAINED
        case Unary(UnaryOperator.NOT), Binary(inner):
            return inner in BOOLEAN
        case _:
            return False


def fitting(
    columns: Sequence[Sequence[str]], states: Sequence[int], decisive: int, columns_left: int
) -> list[range]:
    """Columns that fit into the available width, each as a range of states.

    If not all fit, adjacent equal columns are merged. If that is not enough, the decisive one is
    kept, and as many as fit of: the one before it, the first one, the one further back, the one
    after the decisive one, and those further back still.
    """
    places = [range(n, n + 1) for n in range(len(columns))]
    if sum(width(columns, states, place) for place in places) <= columns_left:
        return places
    places = _merged(columns, states, decisive)
    at = next(n for n, place in enumerate(places) if decisive in place)
    chosen: list[int] = []
    for state in dict.fromkeys([at, at - 1, 0, at - 2, at + 1, *range(at - 3, 0, -1)]):
        if 0 <= state < len(places):
            columns_left -= width(columns, states, places[state])
            if columns_left < 0 and chosen:
                break
            chosen.append(state)
    return [places[number] for number in sorted(chosen)]


def width(columns: Sequence[Sequence[str]], states: Sequence[int], places: range) -> int:
    """Width of a column in characters, with the space before it."""
    cells = (head(states, places), *columns[places[0]])
    return 2 + max(len(cell) for cell in cells)


def head(states: Sequence[int], places: range) -> str:
    """The numbers of the states that a column represents."""
    first, last = states[places[0]], states[places[-1]]
    return str(first) if first == last else f"{first}-{last}"


def _merged(columns: Sequence[Sequence[str]], states: Sequence[int], decisive: int) -> list[range]:
    ranges: list[range] = []
    for place, column in enumerate(columns):
        if (
            place
            and decisive not in (place, place - 1)
            and states[place] == states[place - 1] + 1
            and column == columns[place - 1]
        ):
            ranges[-1] = range(ranges[-1].start, place + 1)
        else:
            ranges.append(range(place, place + 1))
    return ranges
