"""Who goes first on the ways through a junction, by the regulatory elements ``right_of_way``.

They name lanelets before a junction, or those in it. Of whom nobody is told to wait for, or whose
lights say who waits, nothing is known here.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping

import numpy as np
import shapely

from rulec.recordings.lanelet2.map_lanelets import MapLanelet, lanes
from rulec.recordings.lanelet2.regulations import LaneRules, Surveyed, regulatory_elements

_TOWARDS = np.cos(np.radians(120.0))
_MOST_MET = 1_000_000


def first_ways(survey: Surveyed, rules: Mapping[str, LaneRules]) -> dict[str, frozenset[str]]:
    """Lanelet in a junction -> those whose traffic goes before its own.

    Only where that is told of all who come towards it there.
    """
    first: dict[str, frozenset[str]] = {}
    for element in regulatory_elements(survey.file):
        if element.tags.get("subtype") != "right_of_way":
            continue
        prior = _ways(survey, element.refs("right_of_way", "relation"))
        waiting = _ways(survey, element.refs("yield", "relation"))
        if any(rules[name].lights for name in _before(survey, waiting)):
            continue
        for name in waiting:
            first[name] = first.get(name, frozenset()) | prior
    towards = _come_towards(survey, list(first))
    return {name: own for name, own in first.items() if towards.get(name, set()) <= own}


def _ways(survey: Surveyed, names: Iterator[str]) -> frozenset[str]:
    """The lanelets in the junction that some lead into, or are."""
    found: set[str] = set()
    for name in names:
        entry = survey.entries.get(name)
        if entry is not None:
            inside = "intersection" in entry.types or _is_inside(survey, entry)
            found.update([name] if inside else survey.topology.successors[name])
    return frozenset(found)


def _is_inside(survey: Surveyed, entry: MapLanelet) -> bool:
    """True if a lanelet without a word of turns is one of several that begin at one place."""
    before = survey.topology.predecessors[entry.id]
    return any(len(survey.topology.successors[name]) > 1 for name in before)


def _before(survey: Surveyed, names: frozenset[str]) -> Iterator[str]:
    return (x for name in names for x in survey.topology.predecessors[name])


def _come_towards(survey: Surveyed, names: list[str]) -> dict[str, set[str]]:
    """Lanelet -> those in whose way it leads that begin in the opposite direction."""
    found: dict[str, set[str]] = defaultdict(set)
    if not names:
        return found
    all_lanes = list(lanes(survey.entries))
    middles = [shapely.LineString(entry.centre) for entry in all_lanes]
    own = [shapely.LineString(survey.entries[name].centre) for name in names]
    tree, count = shapely.STRtree(middles), 0
    for name, line in zip(names, own, strict=True):
        met = tree.query(line, predicate="crosses").tolist()
        count += len(met)
        if count > _MOST_MET:
            raise survey.file.refused("too many of its lanelets lie on each other")
        for number in met:
            other = all_lanes[number]
            if _ahead(survey.entries[name]) @ _ahead(other) < _TOWARDS:
                found[name].add(other.id)
    return found


def _ahead(entry: MapLanelet) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    step = entry.centre[1] - entry.centre[0]
    ahead: np.ndarray[tuple[int], np.dtype[np.float64]] = step / np.hypot(*step)
    return ahead
