"""Priority at junctions, from regulatory elements ``right_of_way``.

They name lanelets before a junction or within it. At traffic lights, they apply only while the
lights are out of order.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping

import numpy as np
import shapely

from rulec.recordings.lanelet2.map_lanelets import REVERSED
from rulec.recordings.lanelet2.regulations import LaneRules, Surveyed, regulatory_elements
from rulec.recordings.recording import Lanelet

_TOWARDS = np.cos(np.radians(120.0))
_MOST_MET = 1_000_000


def first_ways(survey: Surveyed, rules: Mapping[str, LaneRules]) -> dict[str, frozenset[str]]:
    """Lanelet in a junction -> the lanelets whose traffic has priority over its own.

    Contains only lanelets whose priority relative to all oncoming traffic is known.
    """
    prior: dict[str, frozenset[str]] = defaultdict(frozenset)
    named: set[str] = set()
    for element in regulatory_elements(survey.file):
        if element.tags.get("subtype") != "right_of_way":
            continue
        ahead = _ways(survey, element.refs("right_of_way", "relation"))
        waiting = _ways(survey, element.refs("yield", "relation"))
        if any(rules[name].lights for name in _before(survey, waiting)):
            continue
        named |= ahead | waiting
        for name in waiting:
            prior[name] |= ahead - {name}
    towards = _come_towards(survey, sorted(named))
    first = {}
    for name in named:
        known = {other for other in towards[name] if name in prior[other]} | prior[name]
        if known and towards[name] <= known:
            first[name] = prior[name]
    return first


def _ways(survey: Surveyed, names: Iterator[str]) -> frozenset[str]:
    """The named lanelets that lie in the junction, and the successors of the others."""
    ways: set[str] = set()
    for name in names:
        entry = survey.lanelets.get(name)
        if entry is not None:
            inside = "intersection" in entry.types or _is_inside(survey, entry)
            ways.update([name] if inside else survey.lanelets[name].successors)
    return frozenset(ways)


def _is_inside(survey: Surveyed, entry: Lanelet) -> bool:
    """Whether a lanelet without turn information is one of several with a common predecessor."""
    return any(len(survey.lanelets[name].successors) > 1 for name in entry.predecessors)


def _before(survey: Surveyed, names: frozenset[str]) -> Iterator[str]:
    return (x for name in names for x in survey.lanelets[name].predecessors)


def _come_towards(survey: Surveyed, names: list[str]) -> dict[str, set[str]]:
    """Lanelet -> those that cross or join it and begin in roughly the opposite direction."""
    towards: dict[str, set[str]] = {name: set() for name in names}
    all_lanes = survey.lanes
    tree = shapely.STRtree([shapely.LineString(entry.centre) for entry in all_lanes])
    count = 0
    for name in names:
        entry = survey.lanelets[name]
        met = tree.query(shapely.LineString(entry.centre), predicate="intersects").tolist()
        count += len(met)
        if count > _MOST_MET:
            raise survey.file.refused("too many of its lanelets overlap")
        for number in met:
            other = all_lanes[number]
            itself = other.id.removesuffix(REVERSED) == name.removesuffix(REVERSED)
            if not itself and _ahead(entry) @ _ahead(other) < _TOWARDS:
                towards[name].add(other.id)
    return towards


def _ahead(entry: Lanelet) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    step = entry.centre[1] - entry.centre[0]
    ahead: np.ndarray[tuple[int], np.dtype[np.float64]] = step / np.hypot(*step)
    return ahead
