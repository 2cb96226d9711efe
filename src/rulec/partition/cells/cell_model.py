"""Cells and layers as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rulec.partition.cells.regions import LATERAL_OF, STATION_OF, PartitionName
from rulec.scenario import Box
from rulec.scenario.model import Surface

if TYPE_CHECKING:
    from shapely import Polygon

Signature = dict[str, str] | dict[str, tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Cell:
    """A connected piece of free road whose points all relate to every obstacle in the same way.

    ``boxes`` are rectangles with disjoint interiors that make it up. ``code`` has one byte for each
    of ``objects``, then one for each of the layer's ``alternatives``.
    """

    boxes: tuple[Box, ...]
    surface: Surface
    partition: PartitionName
    objects: tuple[str, ...]
    code: bytes

    @property
    def bounds(self) -> Box:
        """The smallest rectangle around the cell."""
        return Box(
            min(box.s_min for box in self.boxes),
            max(box.s_max for box in self.boxes),
            min(box.d_min for box in self.boxes),
            max(box.d_max for box in self.boxes),
        )

    @property
    def signature(self) -> Signature:
        """Object -> where ego is when in this cell: a letter, or (station, lateral) if ``fine``."""
        if self.partition == "paper":
            return dict(zip(self.objects, self.code.decode("ascii"), strict=False))
        return {
            name: (STATION_OF[code], LATERAL_OF[code])
            for name, code in zip(self.objects, self.code, strict=False)
        }

    @property
    def polygon(self) -> Polygon:
        """The cell in the plane of ``s`` and ``d`` (m), as a shapely polygon."""
        import shapely

        return shapely.union_all(
            [shapely.box(b.s_min, b.d_min, b.s_max, b.d_max) for b in self.boxes]
        )

    def meets(self, region: Box) -> bool:
        """Has it some area in the region?"""
        return any(box.overlaps(region) for box in self.boxes)


@dataclass(frozen=True, slots=True)
class Run:
    """A stretch of one row of a plane that belongs to one cell."""

    s_min: float
    s_max: float
    cell: int


@dataclass(frozen=True, slots=True)
class Row:
    """The free runs between two neighbouring cuts in ``d``, in the order of ``s``."""

    d_min: float
    d_max: float
    runs: tuple[Run, ...]


@dataclass(frozen=True, slots=True)
class Plane:
    """The road cut into cells, for one interval or instant: its rows from right to left."""

    rows: tuple[Row, ...]
    cells: tuple[Cell, ...]

    def cells_at(self, s: float, d: float) -> Iterator[int]:
        """The cells whose closure holds a point: first those to its right, and behind it."""
        for row in self.rows:
            if row.d_min <= d <= row.d_max:
                for run in row.runs:
                    if run.s_min <= s <= run.s_max:
                        yield run.cell


@dataclass(frozen=True, slots=True)
class Layer:
    """The cells of ``[start_s, start_s + step]``; ``neighbours[i]`` are those next to cell ``i``.

    Neighbours are in ascending order, never include the cell itself, and with the adjacency
    ``forward`` need not be mutual. ``alternatives`` are objects as less likely predictions have
    them.
    """

    start_s: float
    objects: tuple[str, ...]
    cells: tuple[Cell, ...]
    neighbours: tuple[tuple[int, ...], ...]
    alternatives: tuple[str, ...] = ()
