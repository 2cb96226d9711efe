"""Shapes of a picture: areas, lines and texts, in px.

``y`` grows downwards. A style is a name in ``styles.STYLES``; a tip is shown when the pointer is
over a mark.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, product
from typing import Literal

from rulec.report.text.terminal_text import broken

Point = tuple[float, float]

Rectangle = tuple[float, float, float, float]
"""Left, top, right, bottom."""

WIDTH = 900.0
"""The width of every picture, so that pictures can be stacked."""

MARGIN = 14.0
"""The free space at the left and the right."""

TEXT_WIDTH = WIDTH - 2 * MARGIN
"""The width between the margins."""

LINE_HEIGHT = 16.0
"""The distance between lines of text."""

CHARACTER = 7.3
"""The width of a character, slightly larger than in the usual fixed-width fonts."""


@dataclass(frozen=True, slots=True)
class Area:
    """A filled shape: an outline and, if there are further rings, holes."""

    rings: tuple[tuple[Point, ...], ...]
    style: str
    tip: str = ""


@dataclass(frozen=True, slots=True)
class Polyline:
    """A line through points."""

    points: tuple[Point, ...]
    style: str
    tip: str = ""


@dataclass(frozen=True, slots=True)
class LabelText:
    """A line of text, vertically centred on ``at``; ``turned`` runs upwards."""

    text: str
    at: Point
    anchor: Literal["start", "middle", "end"] = "start"
    style: str = "ink"
    turned: bool = False

    @property
    def bounds(self) -> Rectangle:
        """The rectangle of its text, which is one line."""
        width, height = text_width([self.text]), LINE_HEIGHT - 2
        before = {"start": 0.0, "middle": width / 2, "end": width}[self.anchor]
        x, y = self.at
        if self.turned:
            return x - height / 2, y - width + before, x + height / 2, y + before
        return x - before, y - height / 2, x - before + width, y + height / 2


Mark = Area | Polyline | LabelText


@dataclass(frozen=True, slots=True)
class Picture:
    """Marks on a ground of this size; later marks are drawn over earlier ones."""

    title: str
    width: float
    height: float
    marks: tuple[Mark, ...]


def text_width(lines: Iterable[str]) -> float:
    """The width of the widest line, enough for any usual fixed-width font."""
    columns = (
        sum(2 if unicodedata.east_asian_width(character) in "WF" else 1 for character in line)
        for line in lines
    )
    return max(columns, default=0) * CHARACTER


def paragraph(text: str, at: Point, width: float, style: str) -> list[LabelText]:
    """A text wrapped to a width, with the middle of its first line at ``at``."""
    lines = broken(text, int(width / CHARACTER))
    x, y = at
    return [LabelText(line, (x, y + n * LINE_HEIGHT), style=style) for n, line in enumerate(lines)]


def corners(rectangle: Rectangle) -> tuple[Point, ...]:
    """The corners of a rectangle, as the ring of an area."""
    left, top, right, bottom = rectangle
    return (left, top), (right, top), (right, bottom), (left, bottom)


def centred(middle: Point, half_width: float, half_height: float) -> Rectangle:
    """A rectangle around a middle."""
    x, y = middle
    return x - half_width, y - half_height, x + half_width, y + half_height


def filled(rectangle: Rectangle, style: str, tip: str = "") -> Area:
    """A rectangle without holes."""
    return Area((corners(rectangle),), style, tip)


def moved(mark: Mark, right: float, down: float) -> Mark:
    """A copy of the mark, moved to the right and down."""

    def there(points: Iterable[Point]) -> tuple[Point, ...]:
        return tuple((x + right, y + down) for x, y in points)

    match mark:
        case Area(rings):
            return replace(mark, rings=tuple(map(there, rings)))
        case Polyline(points):
            return replace(mark, points=there(points))
        case LabelText():
            return replace(mark, at=there([mark.at])[0])


def stacked(title: str, pictures: Sequence[Picture]) -> Picture:
    """The pictures stacked from top to bottom as one."""
    marks: list[Mark] = []
    down = 0.0
    for picture in pictures:
        marks += [moved(mark, 0, down) for mark in picture.marks]
        down += picture.height
    return Picture(title, max(picture.width for picture in pictures), down, tuple(marks))


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
