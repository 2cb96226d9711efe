"""Topology of lanelets: successors by shared ends, neighbours by shared bounds.

As in Lanelet2's routing graph, only shared nodes and ways count, not positions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
import shapely

from rulec.recordings.commonroad.countries import country_of
from rulec.recordings.lanelet2.map_lanelets import MapLanelet
from rulec.recordings.lanelet2.osm_file import OsmFile

MOST_AT_ONE_PLACE = 100
"""The most lanelets that begin, or end, at the same two nodes."""

NEARLY_M = 0.25
"""Nodes so near each other were probably meant to be one."""


@dataclass(frozen=True, slots=True)
class Topology:
    """For each lanelet: its successors, its predecessors, and its neighbour on each side."""

    successors: Mapping[str, tuple[str, ...]]
    predecessors: Mapping[str, tuple[str, ...]]
    left_of: Mapping[str, str]
    right_of: Mapping[str, str]


def topology(file: OsmFile, entries: Mapping[str, MapLanelet]) -> Topology:
    """The topology of lanelets. Raises RulecError R0610 if too many meet at one place."""
    begin: dict[tuple[int, int], list[str]] = defaultdict(list)
    end: dict[tuple[int, int], list[str]] = defaultdict(list)
    for entry in entries.values():
        begin[entry.start].append(entry.id)
        end[entry.end].append(entry.id)
    for group in (*begin.values(), *end.values()):
        if len(group) > MOST_AT_ONE_PLACE:
            why = f"more than {MOST_AT_ONE_PLACE} lanelets begin or end at the same nodes"
            raise file.refused(f"{why}, `{group[0]}` among them")
    # Leaves out a lane of length 0, which would be its own successor
    follow = {x.id: _others(x.id, begin.get(x.end, ())) for x in entries.values()}
    before = {x.id: _others(x.id, end.get(x.start, ())) for x in entries.values()}
    by_right: dict[tuple[str, bool], str] = {}
    by_left: dict[tuple[str, bool], str] = {}
    for entry in entries.values():
        if entry.is_lane:
            by_right.setdefault(entry.right_bound, entry.id)
            by_left.setdefault(entry.left_bound, entry.id)
    lanes = [entry for entry in entries.values() if entry.is_lane]
    left_of = {x.id: by_right[x.left_bound] for x in lanes if x.left_bound in by_right}
    right_of = {x.id: by_left[x.right_bound] for x in lanes if x.right_bound in by_left}
    return Topology(follow, before, left_of, right_of)


def nearly_connected(entries: Mapping[str, MapLanelet], around: Topology) -> list[tuple[str, str]]:
    """Lanelets that end ``NEARLY_M`` or less from where another begins, but do not lead on to it.

    Only pairs of which one leads nowhere, or comes from nowhere: others fork or join elsewhere.
    """
    lanes = [entry for entry in entries.values() if entry.is_lane]
    if not lanes:
        return []
    ends, starts = (np.array([[x.left[at], x.right[at]] for x in lanes]) for at in (-1, 0))
    tree = shapely.STRtree(shapely.points(starts[:, 0]))
    near = tree.query(shapely.points(ends[:, 0]), predicate="dwithin", distance=NEARLY_M)
    apart_m = np.hypot(*np.moveaxis(ends[near[0], 1] - starts[near[1], 1], -1, 0))
    pairs = [(lanes[end], lanes[start]) for end, start in near.T[apart_m <= NEARLY_M].tolist()]
    return [
        (own.id, other.id)
        for own, other in pairs
        if own is not other
        and other.id not in around.successors[own.id]
        and not (around.successors[own.id] and around.predecessors[other.id])
    ]


def _others(own: str, names: Iterable[str]) -> tuple[str, ...]:
    return tuple(name for name in names if name != own)


def country_in(entries: Iterable[MapLanelet]) -> str:
    """The country given by the lanelets; empty if they give none, or several.

    Their regions are such as `de` or `us-ca`.
    """
    regions = {entry.region for entry in entries if entry.region}
    countries = {country_of(x[:2]) if x[2:3] in {"", "-"} else "" for x in regions}
    return countries.pop() if len(countries) == 1 else ""
