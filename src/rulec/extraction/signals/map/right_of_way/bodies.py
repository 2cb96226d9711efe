"""Where the bodies of two participants are at a junction: how soon they follow each other.

The place where two ways meet is as wide as both lanes; bodies are narrower, and take the inside of
a bend.
"""

from __future__ import annotations

from itertools import pairwise
from math import ceil

import numpy as np
import shapely

from rulec.array_types import Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext

_FINE_S = 0.05
"""Bodies are interpolated at least this often: by then they have moved a fraction of a metre."""

_FOLLOWS_S = 1.5
"""One that comes this long (s) after it got to the place where ways meet follows, or is past."""


def gap_s(
    context: DriveContext,
    rows: tuple[int, int],
    columns: tuple[int, int],
    margin_m: float = 0.0,
) -> float:
    """How long (s) after ego's body another one is where ego's was: the post-encroachment time.

    ``rows`` are ego's and the other's, ``columns`` when they get to the place where their ways
    meet. Ego's body is larger by ``margin_m``. Infinite if the other's is nowhere where that was.
    """
    step_s = context.recording.step_s
    begin, end = columns[0] - 1, columns[1] + ceil(_FOLLOWS_S / step_s)
    (ours, ours_at), (theirs, theirs_at) = (_laid_out(context, row, begin, end) for row in rows)
    ours = shapely.buffer(ours, margin_m) if margin_m else ours
    later, earlier = shapely.STRtree(ours).query(theirs, predicate="intersects")
    gaps = theirs_at[later] - ours_at[earlier]
    return float(gaps[gaps >= 0].min(initial=np.inf)) * step_s


@once
def _laid_out(context: DriveContext, row: int, begin: int, end: int) -> tuple[Floats, Floats]:
    """A body's polygons between two columns, interpolated, and the columns of each."""
    tracks = context.surroundings.passages.tracks
    parts = ceil(context.recording.step_s / _FINE_S)
    fine = np.arange(parts) / parts
    rings: list[Floats] = []
    places: list[float] = []
    outlines = [tracks.outline(row, column) for column in range(max(begin, 0), end + 1)]
    for column, (before, after) in enumerate(pairwise(outlines), max(begin, 0)):
        if before is None:
            continue
        # Shapes with other corners in the next state stay as they are
        if after is None or after.shape != before.shape:
            rings.append(before)
            places.append(float(column))
        else:
            rings += list(before + fine[:, None, None] * (after - before))
            places += (column + fine).tolist()
    owners = np.repeat(np.arange(len(rings)), list(map(len, rings)))
    corners = np.concatenate(rings) if rings else np.empty((0, 2))
    return shapely.polygons(shapely.linearrings(corners, indices=owners)), np.array(places)
