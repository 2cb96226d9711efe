"""Rectangles in street-wise coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Box:
    """The closed rectangle ``[s_min, s_max] x [d_min, d_max]``, in metres.

    ``s`` is the arc length along the road, ``d`` the perpendicular offset, positive to the left.
    """

    s_min: float
    s_max: float
    d_min: float
    d_max: float

    def __str__(self) -> str:
        return f"s {self.s_min:g} to {self.s_max:g}, d {self.d_min:g} to {self.d_max:g}"

    def overlaps(self, box: Box) -> bool:
        """Whether the interiors intersect; touching borders do not count."""
        return (
            self.s_min < box.s_max
            and box.s_min < self.s_max
            and self.d_min < box.d_max
            and box.d_min < self.d_max
        )

    def shift_to(self, box: Box) -> tuple[float, float]:
        """The displacement (m) from this centre to another box's, along and across the road."""
        return (
            (box.s_min + box.s_max - self.s_min - self.s_max) / 2,
            (box.d_min + box.d_max - self.d_min - self.d_max) / 2,
        )

    def common(self, box: Box) -> Box:
        """The intersection with a box that it meets."""
        return Box(
            max(self.s_min, box.s_min),
            min(self.s_max, box.s_max),
            max(self.d_min, box.d_min),
            min(self.d_max, box.d_max),
        )

    def covers(self, s: float, d: float) -> bool:
        """Whether the closed rectangle contains the point."""
        return self.s_min <= s <= self.s_max and self.d_min <= d <= self.d_max


def centred(s: float, d: float, length: float, width: float) -> Box:
    """The rectangle around a centre, ``length`` along the road and ``width`` across it."""
    return Box(s - length / 2, s + length / 2, d - width / 2, d + width / 2)


def enclosing(boxes: Sequence[Box]) -> Box:
    """The smallest rectangle that contains all the given ones."""
    return Box(
        min(box.s_min for box in boxes),
        max(box.s_max for box in boxes),
        min(box.d_min for box in boxes),
        max(box.d_max for box in boxes),
    )
