"""The lanelets of a file: bounds in the direction of travel, and the meaning of their tags."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rulec.recordings.lanelet2 import lane_tags
from rulec.recordings.lanelet2.bound_lines import Aligned, aligned, distinct, middle_line
from rulec.recordings.lanelet2.osm_file import OsmFile, OsmRelation, OsmWay
from rulec.recordings.recording import LONGEST_M, NO_LANES, LaneMark, Points

MOST_POINTS = 5_000_000
"""The most points of all bounds together, counting lines once for each lanelet that uses them."""

REVERSED = "_reversed"
"""The ending of the id of the opposite lanelet, where a lanelet may be used in both directions."""

Ends = tuple[int, int]
"""The nodes at which the left and the right bound of a lanelet begin, or end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapLanelet:
    """A lanelet without its surroundings.

    A bound is the id of its way and whether it is reversed; ``rules`` are ids of regulatory
    elements.
    """

    id: str
    types: frozenset[str]
    left: Points
    right: Points
    centre: Points
    left_mark: LaneMark | None
    right_mark: LaneMark | None
    left_bound: tuple[str, bool]
    right_bound: tuple[str, bool]
    start: Ends
    end: Ends
    limit_mps: float | None
    both_ways: bool
    rules: tuple[str, ...]
    junction: str
    region: str

    @property
    def is_lane(self) -> bool:
        """Whether it is part of the carriageway."""
        return not self.types & NO_LANES


def map_lanelets(file: OsmFile, points: Points, left_out: list[str]) -> dict[str, MapLanelet]:
    """The lanelets of a file by id; ids of those without two bounds are added to ``left_out``.

    A lane used by vehicles in both directions becomes two lanelets. Raises RulecError R0610 for a
    bound that is too long, or too many points.
    """
    entries: dict[str, MapLanelet] = {}
    count = 0
    for relation in file.relations.values():
        if relation.tags.get("type") != "lanelet":
            continue
        ways = [list(relation.refs(side, "way")) for side in ("left", "right")]
        bounds = [file.ways.get(refs[0]) if len(refs) == 1 else None for refs in ways]
        left, right = bounds
        if left is None or right is None:
            left_out.append(relation.id)
            continue
        count += len(left.nodes) + len(right.nodes)
        if count > MOST_POINTS:
            why = f"the bounds of its lanelets have more than {MOST_POINTS:,} points"
            raise file.refused(why, relation.place)
        entry = _entry(file, points, relation, left, right)
        if entry is None:
            left_out.append(relation.id)
            continue
        entries[entry.id] = entry
        if entry.both_ways and entry.is_lane:
            against = _reversed(entry)
            entries[against.id] = against
    return entries


def _entry(
    file: OsmFile, points: Points, relation: OsmRelation, left: OsmWay, right: OsmWay
) -> MapLanelet | None:
    left_line, right_line = (distinct(points[list(way.nodes)]) for way in (left, right))
    if left_line is None or right_line is None:
        return None
    for line, way in ((left_line, left), (right_line, right)):
        if np.ptp(line, axis=0).max() > LONGEST_M:
            why = f"a lanelet's bound is longer than {LONGEST_M / 1000:g} km"
            raise file.refused(why, way.place)
    laid = aligned(left_line, right_line)
    start, end = _ends(left, right, laid)
    tags = relation.tags
    types = lane_tags.lane_types(tags)
    lane = not types & NO_LANES
    return MapLanelet(
        id=relation.id,
        types=types,
        left=laid.left,
        right=laid.right,
        centre=middle_line(laid.left, laid.right),
        left_mark=lane_tags.mark(left.tags, turned=laid.left_turned, on_left=False),
        right_mark=lane_tags.mark(right.tags, turned=laid.right_turned, on_left=True),
        left_bound=(left.id, laid.left_turned),
        right_bound=(right.id, laid.right_turned),
        start=start,
        end=end,
        limit_mps=lane_tags.speed_limit(tags) if lane else None,
        both_ways=lane_tags.leads_both_ways(tags),
        rules=tuple(relation.refs("regulatory_element", "relation")),
        junction=tags.get("intersection_area", "") if lane else "",
        region=tags.get("region", ""),
    )


def _ends(left: OsmWay, right: OsmWay, laid: Aligned) -> tuple[Ends, Ends]:
    first, last = (-1, 0) if laid.left_turned else (0, -1)
    other_first, other_last = (-1, 0) if laid.right_turned else (0, -1)
    return (
        (left.nodes[first], right.nodes[other_first]),
        (left.nodes[last], right.nodes[other_last]),
    )


def _reversed(entry: MapLanelet) -> MapLanelet:
    """The lanelet in the opposite direction on the same ground."""
    (left, left_turned), (right, right_turned) = entry.left_bound, entry.right_bound
    return replace(
        entry,
        id=entry.id + REVERSED,
        left=entry.right[::-1],
        right=entry.left[::-1],
        centre=entry.centre[::-1],
        left_mark=entry.right_mark,
        right_mark=entry.left_mark,
        left_bound=(right, not right_turned),
        right_bound=(left, not left_turned),
        start=entry.end[::-1],
        end=entry.start[::-1],
        # Rules of a lane only apply in the direction of its bounds
        rules=(),
    )


def lanes(entries: dict[str, MapLanelet]) -> Iterator[MapLanelet]:
    """The lanelets that are part of the carriageway."""
    return (entry for entry in entries.values() if entry.is_lane)
