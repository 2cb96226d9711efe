"""Arrays of a recording cut to one drive, or to several end to end, and to objects near ego."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

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
from rulec.trace.laid_out import LaidOut, columns_of, one_behind_the_other
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
    relevant, in_sight = _near(places, egos.columns, ego)
    if egos.own is surroundings:
        relevant[own[0], spans.columns] = in_sight[own[0], spans.columns] = False
    are_near = relevant | in_sight
    rows = are_near.any(axis=1).nonzero()[0]
    laid = LaidOut(rows, egos.columns, ~spans.any(are_near[rows]))
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


def _near(places: RoadPlaces, ranges: Sequence[slice], ego: RoadExtents) -> tuple[Flags, Flags]:
    """Masks of the participants (rows) that count for ego and of those in its sight, by state.

    The states of several ``ranges`` are laid end to end.
    """
    limits, extents = places.thresholds, places.extents

    columns = columns_of(ranges)

    def laid(values: NDArray[Any]) -> NDArray[Any]:
        if len(ranges) == 1:
            return values[:, ranges[0]]
        return one_behind_the_other(values, ranges, columns)

    gap = laid(extents.s_min) - ego.s_max
    np.maximum(gap, ego.s_min - laid(extents.s_max), out=gap)
    # A little farther, since speeds are only known to within a tolerance
    reach = ego.along - laid(extents.along)
    reach += 1.0
    np.maximum(reach, 0.0, out=reach)
    reach *= limits.catching_up_s
    relevant = laid(places.counts) & (gap <= limits.near_m) & ~np.isnan(ego.s_min)
    in_sight = laid(places.seen) & (gap <= np.maximum(limits.near_m, reach, out=reach))
    return relevant, in_sight
