"""Places for labels, so that no two overlap."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice, product

from rulec.report.pictures.drawing.canvas import LabelText, Rectangle

_ROOM = 4.0
"""Distance between a label and what is beside it, in px."""

_LARGE = 0.6
"""Share of the largest box's size from which on boxes count as equally good."""

_SHIFTS = (0.5, 0.25, 0.75, 0.1, 0.9)
"""Positions of a label tried within a box, as fractions of its free space."""


@dataclass
class Placing:
    """The rectangles that are occupied."""

    taken: list[Rectangle] = field(default_factory=list)

    def take(self, words: LabelText) -> bool:
        """Occupy a label's place, if nothing is there; return whether it was free."""
        bounds = words.bounds
        if any(_meet(bounds, other) for other in self.taken):
            return False
        self.taken.append(bounds)
        return True

    def first_free(self, choices: Iterable[LabelText]) -> list[LabelText]:
        """Occupy the first choice whose place is free; empty if none is."""
        return list(islice(filter(self.take, choices), 1))

    def place(self, texts: Sequence[str], boxes: Sequence[Rectangle]) -> LabelText | None:
        """Place the first text that fits into a box, upright if possible.

        Of the large boxes the one nearest to the middle is tried first. None if no text fits.
        """
        ordered = sorted(boxes, key=_preference(boxes))
        choices = (
            words
            for text, turned, box in product(texts, (False, True), ordered)
            for words in _within(text, box, turned=turned)
        )
        return next(filter(self.take, choices), None)


def _preference(boxes: Sequence[Rectangle]) -> Callable[[Rectangle], tuple[bool, float, float]]:
    sizes = {box: (box[2] - box[0]) * (box[3] - box[1]) for box in boxes}
    largest = max(sizes.values())
    middle = (min(box[1] for box in boxes) + max(box[3] for box in boxes)) / 2

    def rank(box: Rectangle) -> tuple[bool, float, float]:
        small = sizes[box] < _LARGE * largest
        return small, 0.0 if small else abs((box[1] + box[3]) / 2 - middle), -sizes[box]

    return rank


def _within(text: str, area: Rectangle, *, turned: bool) -> Iterator[LabelText]:
    left, top, right, bottom = area
    box = LabelText(text, (0, 0), "middle", turned=turned).bounds
    spare_x = right - left - (box[2] - box[0]) - 2 * _ROOM
    spare_y = bottom - top - (box[3] - box[1])
    if spare_x < 0 or spare_y < 0:
        return
    for part in _SHIFTS:
        x = left + _ROOM + (box[2] - box[0]) / 2 + part * spare_x
        yield LabelText(text, (x, (top + bottom) / 2), "middle", turned=turned)


def _meet(left: Rectangle, right: Rectangle) -> bool:
    beside = left[0] < right[2] + _ROOM and right[0] < left[2] + _ROOM
    return beside and left[1] < right[3] and right[1] < left[3]
