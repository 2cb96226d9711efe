"""Map places on the road to places in its picture."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.report.pictures.drawing.label_placement import Rectangle
from rulec.report.pictures.drawing.marks import MARGIN, WIDTH, Point
from rulec.scenario import Box

LANE_HEIGHT = 46.0
"""Of a lane as wide as the road's lanes are on average, in px."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Mapping of places on the road to places in the picture."""

    outline: Box
    top: float
    lanes: int

    @property
    def along(self) -> float:
        """Px for a metre of s."""
        return (WIDTH - 2 * MARGIN) / (self.outline.s_max - self.outline.s_min)

    @property
    def across(self) -> float:
        """Px for a metre of d."""
        return LANE_HEIGHT * self.lanes / (self.outline.d_max - self.outline.d_min)

    @property
    def bottom(self) -> float:
        """The lower border of the road, in px."""
        return self.top + LANE_HEIGHT * self.lanes

    def at(self, s: float, d: float) -> Point:
        """A place on the road."""
        return (
            MARGIN + (s - self.outline.s_min) * self.along,
            self.top + (self.outline.d_max - d) * self.across,
        )

    def box(self, box: Box) -> Rectangle:
        """A box as far as it is on the road."""
        left, top = self.at(max(box.s_min, self.outline.s_min), min(box.d_max, self.outline.d_max))
        right, bottom = self.at(
            min(box.s_max, self.outline.s_max), max(box.d_min, self.outline.d_min)
        )
        return left, top, right, bottom
