"""The lanes and lane boundaries of a trace, before they become lanelets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from rulec.recordings.encodings.wire_format import Fields, WireFile
from rulec.recordings.osi.message_fields import id_of, ids_of, part, places
from rulec.recordings.osi.trace_file import OSI
from rulec.recordings.polylines import without_repeats
from rulec.recordings.recording import LONGEST_M, LaneMark, Points

_MARKS: Mapping[str, LaneMark] = {
    "solid_line": "solid",
    "dashed_line": "broken",
    "botts_dots": "broken",
    "no_line": "none",
}
"""Boundary type -> lane mark; kerbs, edges and rails are not marks."""

MOST_REFERENCES = 200_000
MOST_POINTS = 10_000_000
"""Limit on the points of all lanes together; the map of a town has a hundredth of it."""

_CLOSEST_M = 0.001


class Boundary(NamedTuple):
    """A lane boundary: its line, and its mark if it is a marking."""

    line: Points
    mark: LaneMark | None


class TraceLane(NamedTuple):
    """A lane, with left and right as seen along its points.

    ``forward``: whether traffic runs in the direction of the points. Boundaries and adjacent lanes
    are given by id. ``linked``: the lanes before and after it. ``pairs``: for an intersection area,
    the lanes that each way through it leads from and to.
    """

    id: str
    kind: str
    subtype: str
    centre: Points
    forward: bool | None
    left_bounds: tuple[str, ...]
    right_bounds: tuple[str, ...]
    left_of: tuple[str, ...]
    right_of: tuple[str, ...]
    linked: tuple[str, ...]
    pairs: tuple[tuple[str, str], ...] = ()
    limit_mps: float | None = None
    types: frozenset[str] = frozenset()


def read_boundaries(messages: Mapping[str, Fields], file: WireFile) -> dict[str, Boundary]:
    """Boundaries by id, without those that have no line. Raises RulecError R0610."""
    boundaries = {}
    for key, fields in messages.items():
        points = (part(point, "position") for point in fields.get("boundary_line", ()))
        line = line_of(points, file)
        if len(line) > 1:
            kind = part(fields, "classification").get("type", "unknown")
            boundaries[key] = Boundary(line, _MARKS.get(kind))
    return boundaries


def line_of(vectors: Iterable[Fields], file: WireFile) -> Points:
    """A line without repeated points. Raises RulecError R0610 if the points do not make a line."""
    points = places(vectors, file)
    if len(points) and np.ptp(points, axis=0).max() > LONGEST_M:
        why = f"a line of a lane is longer than {LONGEST_M / 1000:g} km"
        raise OSI.refused(file.path, why)
    return without_repeats(points, _CLOSEST_M) if len(points) else points


def read_lanes(messages: Mapping[str, Fields], file: WireFile) -> list[TraceLane]:
    """The lanes of a trace. Raises RulecError R0610."""
    return [_lane(key, part(fields, "classification"), file) for key, fields in messages.items()]


def check_size(
    lanes: Iterable[TraceLane], boundaries: Mapping[str, Boundary], file: WireFile
) -> None:
    """Raise RulecError R0610 if the lanes' references would take too long to follow."""
    references = points = 0
    for lane in lanes:
        bounds = (*lane.left_bounds, *lane.right_bounds)
        references += len(bounds) + len(lane.pairs) + len(lane.linked)
        references += len(lane.left_of) + len(lane.right_of)
        points += len(lane.centre)
        points += sum(len(boundaries[x].line) for x in bounds if x in boundaries)
    if references > MOST_REFERENCES or points > MOST_POINTS:
        why = (
            f"its lanes refer to {references:,} others and boundaries, of {points:,} points:"
            f" at most {MOST_REFERENCES:,} and {MOST_POINTS:,} are read"
        )
        raise OSI.refused(file.path, why)


def _lane(key: str, fields: Fields, file: WireFile) -> TraceLane:
    pairs = [
        (id_of(pair, "antecessor_lane_id"), id_of(pair, "successor_lane_id"))
        for pair in fields.get("lane_pairing", ())
    ]
    centre = line_of(fields.get("centerline", ()), file)
    linked = dict.fromkeys(x for pair in pairs for x in pair if x is not None and x != key)
    return TraceLane(
        id=key,
        kind=fields.get("type", "unknown"),
        subtype=fields.get("subtype", "unknown"),
        centre=centre,
        # Protocol Buffers 3 senders omit false values
        forward=fields.get("centerline_is_driving_direction", False if len(centre) > 1 else None),
        left_bounds=ids_of(fields, "left_lane_boundary_id"),
        right_bounds=ids_of(fields, "right_lane_boundary_id"),
        left_of=ids_of(fields, "left_adjacent_lane_id"),
        right_of=ids_of(fields, "right_adjacent_lane_id"),
        linked=tuple(linked),
        pairs=tuple((before, after) for before, after in pairs if before and after),
    )
