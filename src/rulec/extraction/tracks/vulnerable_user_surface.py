"""The surface under vulnerable road users: lanes, pedestrian crossings, or neither."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely

from rulec.extraction.tracks.tracks import Flags, Tracks
from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.route import is_lane, lanelet_area


def on_lanes(recording: Recording, tracks: Tracks) -> Flags:
    """Flags of vulnerable road users with their middle on a lane.

    They are by row and column; a lane of any direction counts.
    """
    return _on(recording, tracks, is_lane)


def on_crosswalks(recording: Recording, tracks: Tracks) -> Flags:
    """Flags of vulnerable road users with their middle on a pedestrian crossing."""
    return _on(recording, tracks, lambda lanelet: "crosswalk" in lanelet.types)


def _on(recording: Recording, tracks: Tracks, counts: Callable[[Lanelet], bool]) -> Flags:
    flags = np.zeros(tracks.present.shape, dtype=bool)
    rows, columns = np.nonzero(tracks.present & tracks.of_type("vulnerable_user")[:, None])
    areas = [lanelet_area(lanelet) for lanelet in recording.lanelets.values() if counts(lanelet)]
    if areas and len(rows):
        points = shapely.points(tracks.x[rows, columns], tracks.y[rows, columns])
        inside, _ = shapely.STRtree(areas).query(points, predicate="intersects")
        flags[rows[inside], columns[inside]] = True
    return flags
