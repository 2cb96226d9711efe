"""Where the bodies of two participants are at a junction: whether they meet, and how nearly.

The place where two ways meet is as wide as both lanes; bodies are narrower, and take the inside of
a bend.
"""

from __future__ import annotations

from math import ceil

import numpy as np
import shapely

from rulec.array_types import Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.tracks.at_junctions.junction_passages import Passage

_FINE_S = 0.05
"""Bodies are interpolated at least this often: by then they have moved a fraction of a metre."""

_FOLLOWS_S = 1.5
"""One that comes this long (s) after it got to the place where ways meet follows, or is past."""


def collide(
    context: DriveContext, own: Passage, other: Passage, columns: slice, least_m: float = 0.0
) -> bool:
    """Whether two bodies collide in the columns, as ``collision`` has it."""
    return collision(context, own, other, columns, least_m) is not None


def collision(
    context: DriveContext, own: Passage, other: Passage, columns: slice, least_m: float = 0.0
) -> int | None:
    """The column at or after which two bodies first overlap by more than the tolerance of places.

    And by ``least_m`` more; also between it and the next one.
    """
    (ours, ours_at), (theirs, theirs_at) = (
        _laid_out(context, passage.row, columns.start, columns.stop) for passage in (own, other)
    )
    _, here, there = np.intersect1d(ours_at, theirs_at, return_indices=True)
    if not len(here):
        return None
    # Only where they are near are their shapes compared
    near = shapely.dwithin(ours[here], theirs[there], max(-least_m, 0.0))
    inner = -(context.tolerances.place_m + least_m)
    smaller = shapely.buffer(ours[here[near]], inner)
    overlap = shapely.intersects(smaller, theirs[there[near]])
    return int(ours_at[here[near]][overlap][0]) if overlap.any() else None


def gap_s(context: DriveContext, rows: tuple[int, int], columns: tuple[int, int]) -> float:
    """How long (s) after ego's body another one is where ego's was: the post-encroachment time.

    ``rows`` are ego's and the other's, ``columns`` when they get to the place where their ways
    meet. Infinite if the other's body is nowhere where ego's was before.
    """
    step_s = context.recording.step_s
    begin, end = columns[0] - 1, columns[1] + ceil(_FOLLOWS_S / step_s)
    (ours, ours_at), (theirs, theirs_at) = (_laid_out(context, row, begin, end) for row in rows)
    later, earlier = shapely.STRtree(ours).query(theirs, predicate="intersects")
    gaps = theirs_at[later] - ours_at[earlier]
    return float(gaps[gaps >= 0].min(initial=np.inf)) * step_s


def _laid_out(context: DriveContext, row: int, begin: int, end: int) -> tuple[Floats, Floats]:
    """A body's polygons between two columns, interpolated, and the columns of each."""
    tracks = context.surroundings.passages.tracks
    parts = ceil(context.recording.step_s / _FINE_S)
    polygons, places = [], []
    for column in range(max(begin, 0), end):
        before, after = (tracks.outline(row, at) for at in (column, column + 1))
        if before is None:
            continue
        if after is None:
            polygons.append(shapely.Polygon(before))
            places.append(float(column))
            continue
        # Shapes with other corners in the next state stay as they are
        change = after - before if after.shape == before.shape else np.zeros_like(before)
        for part in np.arange(parts) / parts:
            polygons.append(shapely.Polygon(before + part * change))
            places.append(column + part)
    return np.array(polygons, dtype=object), np.array(places)
