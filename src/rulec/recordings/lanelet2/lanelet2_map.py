"""Reads a Lanelet2 map as the roads of a recording."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely

from rulec.diagnostics import first_of
from rulec.recordings.adjacency import side_by_lanes
from rulec.recordings.commonroad.countries import country_of, side_in
from rulec.recordings.commonroad.traffic_signs import MAX_SPEED, MIN_SPEED
from rulec.recordings.lanelet2.map_frame import places_of
from rulec.recordings.lanelet2.map_lanelets import REVERSED, MapLanelet, map_lanelets
from rulec.recordings.lanelet2.osm_file import LANELET2, OsmFile, read_osm
from rulec.recordings.lanelet2.regulations import (
    LaneRules,
    Surveyed,
    regulations,
    regulatory_elements,
    remarks_on,
)
from rulec.recordings.recording import Lanelet, ObservedLight, is_lane
from rulec.recordings.road_map import RoadMap

_NAMED = 3


def read_lanelet2(path: Path) -> RoadMap:
    """Read a Lanelet2 map.

    Raises RulecError R0610 for a file that cannot be read as one, R0701 if it cannot be opened.
    """
    file = read_osm(path)
    if not any(x.tags.get("type") == "lanelet" for x in file.relations.values()):
        raise LANELET2.refused(
            path,
            "it has no lanelets; it may be plain OpenStreetMap, which has roads without lanes",
            help_text="give a Lanelet2 map, whose relations of the type `lanelet` have a left and "
            "a right bound",
        )
    places = places_of(file)
    left_out: list[str] = []
    entries = map_lanelets(file, places.points, left_out)
    if not entries:
        raise file.refused("none of its lanelets has a left and a right bound")
    survey = Surveyed(file, places.points, connected(file, entries))
    rules = regulations(survey)
    first = first_ways(survey, rules)
    country = country_in(file, entries)
    lanelets = {
        name: _regulated(lanelet, rules[name], first.get(name))
        for name, lanelet in survey.lanelets.items()
    }
    side = side_in(country) or side_by_lanes(lanelets.values())
    remarks = [places.remark, *_left_out(left_out), *remarks_on(rules.values())]
    remarks += _loose_ends(nearly_connected(lanelets))
    if side is None:
        remarks.append("the map does not give the side of traffic")
    return RoadMap(
        form="Lanelet2 map",
        lanelets=lanelets,
        side=side,
        country=country,
        remarks=tuple(filter(None, remarks)),
    )


def _regulated(lanelet: Lanelet, rules: LaneRules, first: frozenset[str] | None) -> Lanelet:
    own = () if lanelet.limit_mps is None else (lanelet.limit_mps,)
    limits = rules.limits if is_lane(lanelet) and rules.limits else own
    untold = frozenset(rules.untold | ({MAX_SPEED} if rules.unnumbered and not limits else set()))
    return replace(
        lanelet,
        types=lanelet.types | ({"directed"} if rules.directed else frozenset()),
        signs=frozenset(rules.signs),
        untold_signs=untold,
        limit_mps=None if MAX_SPEED in untold else min(limits, default=None),
        minimum_mps=None if MIN_SPEED in untold else max(rules.minima, default=None),
        lights=tuple(rules.lights),
        lights_to=_single(rules.lights_to),
        stop_line=rules.stop_line,
        first=first,
    )


def _single(lights: Mapping[str, list[ObservedLight]]) -> dict[str, ObservedLight]:
    """The light for each way on that has exactly one; several lights all apply to the way."""
    return {onward: own[0] for onward, own in lights.items() if len(own) == 1}


def _left_out(names: list[str]) -> Iterator[str]:
    if names:
        some = first_of([f"`{name}`" for name in names], _NAMED)
        yield f"lanelets without a left and a right bound are left out: {some}"


def _loose_ends(pairs: list[tuple[str, str]]) -> Iterator[str]:
    if pairs:
        some = first_of([f"`{own}` and `{other}`" for own, other in pairs], _NAMED)
        yield (
            "lanelets end where others begin, but share no nodes with them, so that no way leads "
            f"from one to the other: {some}"
        )


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
