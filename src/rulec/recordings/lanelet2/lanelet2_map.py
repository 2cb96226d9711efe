"""Reads a Lanelet2 map as the roads of a recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from rulec.diagnostics import first_of
from rulec.recordings.adjacency import side_by_lanes
from rulec.recordings.commonroad.countries import side_in
from rulec.recordings.commonroad.traffic_signs import MAX_SPEED, MIN_SPEED
from rulec.recordings.lanelet2.first_ways import first_ways
from rulec.recordings.lanelet2.map_frame import places_of
from rulec.recordings.lanelet2.map_lanelets import map_lanelets
from rulec.recordings.lanelet2.osm_file import LANELET2, read_osm
from rulec.recordings.lanelet2.regulations import LaneRules, Surveyed, regulations, remarks_on
from rulec.recordings.lanelet2.topology import connected, country_in, nearly_connected
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
