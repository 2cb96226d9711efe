"""Arrays of a recording cut to one drive, or to several end to end, and to objects near ego."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.recordings.recording import Side
from rulec.trace.end_to_end import EndToEnd
from rulec.trace.laid_out import LaidOut, columns_of
from rulec.trace.plain_arrays import keep_freed_memory


@dataclass(frozen=True, eq=False, slots=True)
class EgosOnRoad:
    """Drives along one road: their rows in ``places`` and the columns of each.

    ``own`` are the egos' surroundings; ``alone`` returns the surroundings of a single ego, and its
    row in them, by the number of its drive.
    """

    places: RoadPlaces
    rows: Sequence[int]
    columns: Sequence[slice]
    own: Surroundings
    alone: Callable[[int], tuple[Surroundings, int]] | None = None


def drives_context(
    surroundings: Surroundings, places: RoadPlaces, side: Side, egos: EgosOnRoad
) -> DriveContext:
    """The parts of a recording that concern one drive, or several along one road, end to end.

    Egos that have surroundings of their ``own`` are not among the other participants.
    """
    keep_freed_memory()
    lengths = [columns.stop - columns.start for columns in egos.columns]
    spans = EndToEnd((0, *accumulate(lengths)))
    columns = columns_of(egos.columns)
    members = np.array(egos.rows, dtype=intp)
    own = spans.spread(members)[None], columns[None]
    ego = egos.places.extents.at(*own)
    relevant, in_sight = _near(places, columns, ego)
    if egos.own is surroundings:
        relevant[own[0], spans.columns] = in_sight[own[0], spans.columns] = False
    are_near = relevant | in_sight
    rows = are_near.any(axis=1).nonzero()[0]
    laid = LaidOut(rows, columns, ~spans.any(are_near[rows]))
    return DriveContext(
        recording=surroundings.recording,
        thresholds=places.thresholds,
        side=side,
        road=places.road,
        spans=spans,
        steps=places.tracks.first + columns,
        own=egos.own,
        ego=egos.places.tracks.at(*own, members),
        ego_extents=ego,
        tracks=places.tracks.end_to_end(laid),
        extents=places.extents.end_to_end(laid),
        relevant=relevant[rows],
        in_sight=in_sight[rows],
        lanes_there=laid(places.lanes_there),
        lanes_within=tuple(
            laid(sets) for sets in places.lanes_within(surroundings.tolerances.place_m)
        ),
        elsewhere=laid(places.elsewhere),
        surroundings=surroundings,
        alone=egos.alone,
    )


def _near(places: RoadPlaces, columns: NDArray[intp], ego: RoadExtents) -> tuple[Flags, Flags]:
    """Masks of the participants (rows) that count for ego and of those in its sight, by state.

    The states are those in some ``columns``.
    """
    limits, extents = places.thresholds, places.extents

    gap = np.maximum(
        extents.s_min.take(columns, axis=1) - ego.s_max,
        ego.s_min - extents.s_max.take(columns, axis=1),
    )
    # A little farther, since speeds are only known to within a tolerance
    faster = np.maximum(ego.along - extents.along.take(columns, axis=1) + 1.0, 0.0)
    reach = np.maximum(limits.near_m, faster * limits.catching_up_s)
    relevant = places.counts.take(columns, axis=1) & (gap <= limits.near_m) & ~np.isnan(ego.s_min)
    in_sight = places.seen.take(columns, axis=1) & (gap <= reach)
    return relevant, in_sight
