"""Traffic signs of Lanelet2 maps, with the names used in recordings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from math import floor, isfinite

from rulec.recordings.commonroad.countries import country_of
from rulec.recordings.commonroad.traffic_signs import (
    CATALOGUED,
    LIMITS,
    MAX_SPEED,
    MIN_SPEED,
    UNKNOWN,
    ZONE,
    Sign,
    effect_name,
    is_plate,
    national_sign,
    with_plates,
)
from rulec.recordings.encodings.speed_units import MPS_PER_KMH
from rulec.recordings.lanelet2.lane_tags import velocity
from rulec.recordings.lanelet2.osm_file import OsmFile, OsmRelation, OsmWay
from rulec.recordings.recording import Points

AUTOWARE_SIGNS = {"stop_sign": "STOP", "yield_sign": "YIELD"}
"""Names of signs that do not depend on a country."""

_GERMAN_LIMIT = re.compile(
    r"de[ _:-]?(?:(?P<zone>274[._-]1)|(?P<least>275)|274)[-_](?P<kmh>\d{1,3})$", re.IGNORECASE
)
_SLOWEST_KMH = 5
"""Lower numbers on a sign of Germany's are no speeds: 274.1 begins a zone, 274.2 ends it."""


def sign_of(kind: str) -> Sign:
    """The sign named by a subtype or ``sign_type``; ``UNKNOWN`` for signs not about driving.

    `de274-50` is the limit of 50 km/h, and so is `50 km/h` in place of a sign's name.
    """
    if kind in AUTOWARE_SIGNS:
        return Sign(AUTOWARE_SIGNS[kind])
    limit = _GERMAN_LIMIT.match(kind)
    if limit is not None and int(limit["kmh"]) >= _SLOWEST_KMH:
        name = ZONE if limit["zone"] else MIN_SPEED if limit["least"] else MAX_SPEED
        return Sign(name, int(limit["kmh"]) * MPS_PER_KMH)
    country, number = _sign_parts(kind)
    if country and country not in CATALOGUED | {"DEU"}:
        return Sign(UNKNOWN)
    if country:
        spelled = (number, number.replace("_", "-"), number.replace("_", "."))
        tried = (*spelled, *(word.upper() for word in spelled))
        names = (national_sign(word, country) for word in tried)
        name = next((name for name in names if name != UNKNOWN), UNKNOWN)
        return Sign(name, untold=effect_name(name) if name in LIMITS | {MIN_SPEED} else "")
    speed = velocity(kind)
    return Sign(UNKNOWN) if speed is None else Sign(MAX_SPEED, speed)


def _sign_parts(kind: str) -> tuple[str, str]:
    """The country and number in a sign's name such as `de206`; empty for other names."""
    country, number = country_of(kind[:2]), kind[2:].lstrip("_-: ")
    return (country, number) if country and number else ("", "")


def plate_of(kind: str) -> str:
    """The number of the plate named by a subtype; empty for other signs."""
    country, number = _sign_parts(kind)
    number = number.replace("_", "-")
    if country != "DEU" and (country not in CATALOGUED or sign_of(kind).name != UNKNOWN):
        return ""
    return number if is_plate(number, country) else ""


Plates = Mapping[tuple[int, int], tuple[str, ...]]
"""Squares of the map, by their whole metres -> the numbers of plates there."""

_SPEEDS_END = frozenset({"MAX_SPEED_END", "MAX_SPEED_ZONE_END", "ALL_MAX_SPEED_AND_OVERTAKING_END"})


def tells_speed(signs: Iterable[Sign]) -> bool:
    """Whether signs say how fast one may or must be, or would if plates did not limit them."""
    return any(
        x.limit_mps is not None or x.name in _SPEEDS_END or (x.untold and x.name == UNKNOWN)
        for x in signs
    )


def plates_of(file: OsmFile, points: Points) -> Plates:
    """The plates of a file, which may stand below signs without a rule that refers to them."""
    found: dict[tuple[int, int], tuple[str, ...]] = {}
    for way in file.ways.values():
        number = plate_of(way.tags.get("subtype", "")) if _is_sign(way) else ""
        if number:
            square = _square(way, points)
            found[square] = (*found.get(square, ()), number)
    return found


def element_signs(
    file: OsmFile, points: Points, element: OsmRelation, plates: Plates
) -> tuple[Sign, ...]:
    """The signs of a regulatory element, as the plates among or below them leave them."""
    ways = [file.ways[name] for name in element.refs("refers", "way") if name in file.ways]
    ways = [way for way in ways if _is_sign(way)]
    kinds = [element.tags.get("sign_type", ""), *(way.tags.get("subtype", "") for way in ways)]
    kinds = list(dict.fromkeys(filter(None, kinds)))
    below = {plate_of(kind) for kind in kinds} - {""}
    for way in ways:
        x, y = _square(way, points)
        below.update(*(plates.get((x + dx, y + dy), ()) for dx in (-1, 0, 1) for dy in (-1, 0, 1)))
    return tuple([with_plates(sign_of(kind), below) for kind in kinds if not plate_of(kind)])


def _is_sign(way: OsmWay) -> bool:
    return way.tags.get("type") == "traffic_sign" and bool(way.nodes)


def _square(way: OsmWay, points: Points) -> tuple[int, int]:
    x, y = points[list(way.nodes)].mean(axis=0).tolist()
    return (floor(x), floor(y)) if isfinite(x) and isfinite(y) else (0, 0)
