"""Topology of lanelets: successors by shared ends, neighbours by shared bounds.

As in Lanelet2's routing graph, only shared nodes and ways count, not positions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
import shapely

from rulec.recordings.commonroad.countries import country_of
from rulec.recordings.lanelet2.map_lanelets import MapLanelet
from rulec.recordings.lanelet2.osm_file import OsmFile
from rulec.recordings.recording import Lanelet, is_lane

MOST_AT_ONE_PLACE = 100
"""The most lanelets that begin, or end, at the same two nodes."""

NEARLY_M = 0.25
"""Nodes so near each other were probably meant to be one."""


def connected(file: OsmFile, entries: Mapping[str, MapLanelet]) -> dict[str, Lanelet]:
    """The lanelets with what they lead to and what is beside them.

    Raises RulecError R0610 if too many meet at one place.
    """
    places = {
        name: tuple(zip(entry.left.ends, entry.right.ends, strict=True))
        for name, entry in entries.items()
    }
    begin: dict[tuple[int, int], list[str]] = defaultdict(list)
    end: dict[tuple[int, int], list[str]] = defaultdict(list)
    for name, (first, last) in places.items():
        begin[first].append(name)
        end[last].append(name)
    for group in (*begin.values(), *end.values()):
        if len(group) > MOST_AT_ONE_PLACE:
            why = f"more than {MOST_AT_ONE_PLACE} lanelets begin or end at the same nodes"
            raise file.refused(f"{why}, `{group[0]}` among them")
    by_right: dict[tuple[str, bool], str] = {}
    by_left: dict[tuple[str, bool], str] = {}
    for name, entry in entries.items():
        if is_lane(entry.lanelet):
            by_right.setdefault(entry.right.key, name)
            by_left.setdefault(entry.left.key, name)
    return {
        # Leaves out a lane of length 0, which would be its own successor
        name: replace(
            entry.lanelet,
            successors=_others(name, begin.get(places[name][1], ())),
            predecessors=_others(name, end.get(places[name][0], ())),
            left_of=by_right.get(entry.left.key) if is_lane(entry.lanelet) else None,
            right_of=by_left.get(entry.right.key) if is_lane(entry.lanelet) else None,
        )
        for name, entry in entries.items()
    }


def nearly_connected(lanelets: Mapping[str, Lanelet]) -> list[tuple[str, str]]:
    """Lanelets that end ``NEARLY_M`` or less from where another begins, but do not lead on to it.

    Only pairs of which one leads nowhere, or comes from nowhere: others fork or join elsewhere.
    """
    lanes = [lanelet for lanelet in lanelets.values() if is_lane(lanelet)]
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
        and other.id not in own.successors
        and not (own.successors and other.predecessors)
    ]


def _others(own: str, names: Iterable[str]) -> tuple[str, ...]:
    return tuple(name for name in names if name != own)


def country_in(file: OsmFile, lanelets: Iterable[str]) -> str:
    """The country given by the lanelets; empty if they give none, or several.

    Their regions are such as `de` or `us-ca`.
    """
    tags = [file.relations[name].tags for name in lanelets if name in file.relations]
    regions = {own["region"] for own in tags if own.get("region")}
    countries = {country_of(x[:2]) if x[2:3] in {"", "-"} else "" for x in regions}
    return countries.pop() if len(countries) == 1 else ""
