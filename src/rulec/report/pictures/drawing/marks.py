"""Marks that a picture consists of: areas, lines and words, in px.

``y`` grows downwards. A style is a name in ``styles.STYLES``; a tip is what a reader is told who
points at a mark.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from rulec.report.pictures.drawing.text_metrics import text_width

Point = tuple[float, float]

WIDTH = 900.0
"""Of every picture, so that they can stand below each other."""

MARGIN = 14.0
"""Left free at the sides."""

LINE_HEIGHT = 16.0
"""From one line of text to the next."""


@dataclass(frozen=True, slots=True)
class Area:
    """A filled shape: an outline and, if there are more rings, holes."""

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
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom, with room for one line."""
        width, height = text_width([self.text]), LINE_HEIGHT - 2
        before = {"start": 0.0, "middle": width / 2, "end": width}[self.anchor]
        x, y = self.at
        if self.turned:
            return x - height / 2, y - width + before, x + height / 2, y + before
        return x - before, y - height / 2, x - before + width, y + height / 2


Mark = Area | Polyline | LabelText


@dataclass(frozen=True, slots=True)
class Picture:
    """Marks, the later above the earlier, on a ground of this size."""

    title: str
    width: float
    height: float
    marks: tuple[Mark, ...]


def rectangle(left: float, top: float, right: float, bottom: float) -> tuple[Point, ...]:
    """The corners of a rectangle."""
    return (left, top), (right, top), (right, bottom), (left, bottom)


def moved(mark: Mark, right: float, down: float) -> Mark:
    """A copy of the mark at another place."""

    def there(points: Iterable[Point]) -> tuple[Point, ...]:
        return tuple((x + right, y + down) for x, y in points)

    match mark:
        case Area(rings):
            return replace(mark, rings=tuple(there(ring) for ring in rings))
        case Polyline(points):
            return replace(mark, points=there(points))
        case LabelText():
            return replace(mark, at=there([mark.at])[0])


def stacked(title: str, pictures: Sequence[Picture]) -> Picture:
    """One picture below the other."""
    marks: list[Mark] = []
    down = 0.0
    for picture in pictures:
        marks += [moved(mark, 0, down) for mark in picture.marks]
        down += picture.height
    return Picture(title, max(picture.width for picture in pictures), down, tuple(marks))
