"""Cells and layers as data."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rulec.partition.cells.regions import LATERAL_OF, STATION_OF, PartitionName
from rulec.scenario import Box
from rulec.scenario.scenario_model import Surface
from rulec.value_display import short_repr

if TYPE_CHECKING:
    from shapely import Polygon

Signature = dict[str, str] | dict[str, tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Cell:
    """Connected piece of free road with one relation to every obstacle.

    ``boxes`` are rectangles with disjoint interiors whose union is the cell. ``code`` has one byte
    for each of ``objects``, then one for each of the layer's ``alternatives``.
    """

    __repr__ = short_repr

    boxes: tuple[Box, ...]
    surface: Surface
    partition: PartitionName
    objects: tuple[str, ...]
    code: bytes

    @property
    def bounds(self) -> Box:
        """The smallest rectangle around the cell."""
        s = [place for box in self.boxes for place in (box.s_min, box.s_max)]
        d = [place for box in self.boxes for place in (box.d_min, box.d_max)]
        return Box(min(s), max(s), min(d), max(d))

    @property
    def signature(self) -> Signature:
        """Relation to every object: a letter, or (station, lateral) if ``fine``."""
        if self.partition == "paper":
            return dict(zip(self.objects, self.code.decode("ascii"), strict=False))
        return {
            name: (STATION_OF[code], LATERAL_OF[code])
            for name, code in zip(self.objects, self.code, strict=False)
        }

    @property
    def polygon(self) -> Polygon:
        """Shapely polygon of the cell in ``s`` and ``d`` (m)."""
        import shapely  # imported late: 0.1 s, rarely needed

        return shapely.union_all(
            [shapely.box(b.s_min, b.d_min, b.s_max, b.d_max) for b in self.boxes]
        )

    def meets(self, region: Box) -> bool:
        """Whether the cell shares some area with the region."""
        return any(box.overlaps(region) for box in self.boxes)


def passes_only(here: Cell, there: Cell) -> bool:
    """Whether ego, going from one cell to the other, changes only the surface, or passes others.

    These stay in other lanes on the same side; only ego's station relative to them differs. Among
    fast vehicles it may differ during the step alone: the cells are the same pieces of road, moved.
    """
    if here.objects == there.objects:
        size = len(here.objects)
        pairs: Iterable[tuple[int, int]] = zip(here.code[:size], there.code[:size], strict=True)
    else:
        own = dict(zip(there.objects, there.code, strict=False))
        codes = zip(here.objects, here.code, strict=False)
        pairs = ((code, own[name]) for name, code in codes if name in own)
    changed = [(before, after) for before, after in pairs if before != after]
    if here.partition == "paper":
        return here.surface != there.surface and not changed
    return all(LATERAL_OF[x] == LATERAL_OF[y] != "same_lane" for x, y in changed)


@dataclass(frozen=True, slots=True)
class Run:
    """Stretch of one row of a plane within one cell."""

    s_min: float
    s_max: float
    cell: int


@dataclass(frozen=True, slots=True)
class Row:
    """Free runs between two neighbouring cuts in ``d``, ordered by ``s``."""

    d_min: float
    d_max: float
    runs: tuple[Run, ...]


@dataclass(frozen=True, slots=True)
class Plane:
    """The road divided into cells at some time, with rows from right to left."""

    rows: tuple[Row, ...]
    cells: tuple[Cell, ...]

    def cells_at(self, s: float, d: float) -> Iterator[int]:
        """Cells whose closure contains a point; those to the right and behind come first."""
        for row in self.rows:
            if row.d_min <= d <= row.d_max:
                for run in row.runs:
                    if run.s_min <= s <= run.s_max:
                        yield run.cell


@dataclass(frozen=True, slots=True)
class Reach:
    """Bounds of ego's place (m) and speed (m/s) in a cell at the beginning of its layer."""

    s: tuple[float, float]
    d: tuple[float, float]
    speed: tuple[float, float]
    lateral_speed: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Layer:
    """Cells of ``[start_s, start_s + step]``.

    ``neighbours[i]`` are the cells adjacent to cell ``i``, ascending, never the cell itself; with
    the adjacency ``forward`` they need not be mutual. ``alternatives`` are the objects by less
    likely predictions.
    """

    __repr__ = short_repr

    start_s: float
    objects: tuple[str, ...]
    cells: tuple[Cell, ...]
    neighbours: tuple[tuple[int, ...], ...]
    alternatives: tuple[str, ...] = ()
