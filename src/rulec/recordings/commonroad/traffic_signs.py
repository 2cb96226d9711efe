"""Traffic signs of CommonRoad files: their ids in each country, and their names.

The names are those of `commonroad-io`, the ids those of each country's catalogue of signs. The
tables contain signs about driving; all others are called ``UNKNOWN``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from math import inf
from types import MappingProxyType
from typing import NamedTuple

from rulec.recordings.encodings.speed_units import SPEED_UNITS
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording import LEAST_SPEED_SIGN, LIMIT_SIGN, REGULATING

MAX_SPEED = LIMIT_SIGN
MIN_SPEED = LEAST_SPEED_SIGN
ZONE = "MAX_SPEED_ZONE_START"
LIMITS = frozenset({MAX_SPEED, ZONE})
UNKNOWN = "UNKNOWN"
_GERMAN_MAX_SPEED = "274"
"""Germany's id for a speed limit, which files of all countries use."""


def _signs(text: str) -> dict[str, str]:
    """Names by id, from pairs separated by commas."""
    words = text.replace(",", " ").split()
    return dict(zip(words[::2], words[1::2], strict=True))


_GERMANY = _signs("""
101 WARNING_DANGER_SPOT, 102 WARNING_RIGHT_BEFORE_LEFT, 103-10 WARNING_LEFT_CURVE,
103-20 WARNING_RIGHT_CURVE, 108 WARNING_STEEP_HILL_DOWNWARDS, 114 WARNING_SLIPPERY_ROAD,
123 WARNING_CONSTRUCTION_SITE, 124 WARNING_TRAFFIC_QUEUES_LIKELY, 125 WARNING_ONCOMING_TRAFFIC,
131 WARNING_TRAFFIC_LIGHTS_AHEAD, 133-10 WARNING_PEDESTRIANS_RIGHT,
133-20 WARNING_PEDESTRIANS_LEFT, 138 WARNING_CROSSING_CYCLIST,
142-10 WARNING_ANIMAL_CROSSING_RIGHT, 145-50 WARNING_LOOSE_GRAVEL, 201 RAILWAY, 205 YIELD,
206 STOP, 208 PRIORITY_OPPOSITE_DIRECTION, 209-10 TURN_RIGHT_AHEAD, 209-20 TURN_LEFT_AHEAD,
209-30 KEEP_STRAIGHT_AHEAD, 211-20 PRESCRIBED_DIRECTION_RIGHT, 215 ROUNDABOUT,
220-10 ONEWAY_RIGHT, 220-20 ONEWAY_LEFT, 222-10 PRESCRIBED_PASSING_LEFT,
222-20 PRESCRIBED_PASSING_RIGHT, 223.2 DO_NOT_DRIVE_ON_SHOULDER_LANE,
223.2-50 DO_NOT_DRIVE_ON_SHOULDER_LANE_2_LANE, 223.2-51 DO_NOT_DRIVE_ON_SHOULDER_LANE_3_LANE,
224-50 BUS_STOP, 237 BIKEWAY, 239 PEDESTRIAN_SIDEWALK, 240 PEDESTRIAN_AND_BICYCLE_ROAD,
242.1 PEDESTRIAN_ZONE_START, 242.2 PEDESTRIAN_ZONE_END, 244.1 BICYCLE_ROAD_START,
244.2 BICYCLE_ROAD_END, 245 BUS_LANE, 250 BAN_ALL_VEHICLES, 251 BAN_CARS, 253 BAN_TRUCKS,
254 BAN_BICYCLE, 255 BAN_MOTORCYCLE, 257-54 BAN_BUS, 259 BAN_PEDESTRIAN,
260 BAN_CAR_TRUCK_BUS_MOTORCYCLE, 261 BAN_VEHICLES_CARRYING_DANGEROUS_GOODS, 262 MAX_WEIGHT,
264 MAX_WIDTH, 265 MAX_HEIGHT, 266 MAX_LENGTH, 267 NO_ENTRY, 270.1 ENVIRONMENTAL_ZONE_START,
270.2 ENVIRONMENTAL_ZONE_END, 272 U_TURN, 274 MAX_SPEED, 274.1 MAX_SPEED_ZONE_START,
274.2 MAX_SPEED_ZONE_END, 275 MIN_SPEED, 276 NO_OVERTAKING_START,
277 NO_OVERTAKING_TRUCKS_START, 278 MAX_SPEED_END, 280 NO_OVERTAKING_END,
281 NO_OVERTAKING_TRUCKS_END, 282 ALL_MAX_SPEED_AND_OVERTAKING_END, 283-10 NO_STOP_START_RIGHT,
283-30 NO_STOP_CENTER_RIGHT, 286-30 RESTRICTED_STOP_CENTER_RIGHT, 301 RIGHT_OF_WAY,
306 PRIORITY, 308 PRIORITY_OVER_ONCOMING, 310 TOWN_SIGN, 311 TOWN_SIGN_BACK, 314 PARKING_AREA,
314-10 PARKING_AREA_LEFT, 314-20 PARKING_AREA_RIGHT, 314-30 PARKING_AREA_RIGHT_LEFT,
325.1 TRAFFIC_CALMED_AREA_START, 325.2 TRAFFIC_CALMED_AREA_END, 327 TUNNEL, 328 EMERGENCY_STOP,
330.1 INTERSTATE_START, 330.2 INTERSTATE_END, 331.1 HIGHWAY_START, 331.2 HIGHWAY_END,
350 PEDESTRIANS_CROSSING, 720 GREEN_ARROW
""")
"""Germany's signs; also used for countries without a table, among them Zamunda."""

_COUNTRIES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "USA": _signs("""
R1-1 STOP, R1-3 STOP_4_WAY, R2-1 MAX_SPEED, R3-4 U_TURN, CW20-1 ROAD_WORK_AHEAD,
R7-1 NO_PARKING_ANY_TIME, R7-4 NO_STANDING, R7-201a TOW_AWAY_ZONE, R6-1L ONE_WAY_LEFT,
R6-1R ONE_WAY_RIGHT, R5-1 DO_NOT_ENTER, R3-2 NO_LEFT_TURN, R3-5R RIGHT_TURN_ONLY,
R3-8b TURN_ONLY_LANES, R3-1 NO_RIGHT_TURN, R4-7 KEEP_RIGHT, R10-11 NO_TURN_ON_RED, R1-6 ONEWAY,
W3-3 SIGNAL_AHEAD, R8-3gP LOADING_ZONE, R8-3 NO_PARKING, R3-5L LEFT_TURN_ONLY,
R3-27 NO_STRAIGHT_THROUGH, W1-3L LEFT_REVERSE_TURN, W11-2 PEDESTRIAN_WARNING,
M6-2aL DIAGONAL_DOWNWARD_LEFT_ARROW, W4-2R RIGHT_LANE_ENDS, R7-8 RESERVED_HANDICAP_PARKING,
R7-107 NO_PARKING_BUS_STOP, R8-3C ON_PAVEMENT, R10-7 DO_NOT_BLOCK_INTERSECTION,
W1-6L WARNING_ARROW_LEFT
"""),
        "ESP": _signs("""
r1 YIELD, r2 STOP, r100 BAN_ALL_VEHICLES, r101 NO_ENTRY, r106 BAN_TRUCKS, r107 MAX_WEIGHT,
r205 MAX_HEIGHT, r301 MAX_SPEED, r305 NO_OVERTAKING_START, r307 NO_STOPPING, r308 NO_WAITING,
s13 PEDESTRIANS_CROSSING
"""),
        "AUS": _signs("R1-1 STOP, R1-2 YIELD, R3-1 PEDESTRIANS_CROSSING"),
        "RUS": _signs("3.24 MAX_SPEED"),
        "ARG": _signs("R15 MAX_SPEED"),
        "BEL": _signs("C43 MAX_SPEED"),
        "FRA": _signs("B14 MAX_SPEED"),
        "GRC": _signs("Ρ-32 MAX_SPEED"),
        "HRV": _signs("B31 MAX_SPEED"),
        "PRI": _signs("R2-1 MAX_SPEED"),
        "CHN": {},
        "ITA": {},
    }
)


_SPAIN = _signs("""
R1 YIELD, R2 STOP, R3 PRIORITY, R101 NO_ENTRY, R301 MAX_SPEED, R305 NO_OVERTAKING_START,
R402 ROUNDABOUT, R500 ALL_MAX_SPEED_AND_OVERTAKING_END, R501 MAX_SPEED_END, R502 NO_OVERTAKING_END,
R503 NO_OVERTAKING_TRUCKS_END
""")
"""Spain's signs as its catalogue spells them, but for the hyphen behind R."""

_MORE: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "AUS": _signs("R1-3 ROUNDABOUT, R4-1 MAX_SPEED"),
        "BEL": _signs("""
B1 YIELD, B5 STOP, B9 PRIORITY, B15 RIGHT_OF_WAY, D5 ROUNDABOUT, C35 NO_OVERTAKING_START,
C37 NO_OVERTAKING_END, C45 MAX_SPEED_END, C46 ALL_MAX_SPEED_AND_OVERTAKING_END,
F4A MAX_SPEED_ZONE_START, F4B MAX_SPEED_ZONE_END
"""),
        "CHE": _signs("""
2.30 MAX_SPEED, 2.30.1 MAX_SPEED, 2.41.1 ROUNDABOUT, 2.44 NO_OVERTAKING_START,
2.53 MAX_SPEED_END, 2.53.1 MAX_SPEED_END, 2.55 NO_OVERTAKING_END,
2.58 ALL_MAX_SPEED_AND_OVERTAKING_END, 3.01 STOP, 3.02 YIELD, 3.03 PRIORITY
"""),
        "ESP": {**_SPAIN, **{f"R-{number[1:]}": name for number, name in _SPAIN.items()}},
        "FRA": _signs("""
AB3A YIELD, AB4 STOP, AB6 PRIORITY, B3 NO_OVERTAKING_START, B30 MAX_SPEED_ZONE_START,
B31 ALL_MAX_SPEED_AND_OVERTAKING_END, B33 MAX_SPEED_END, B34 NO_OVERTAKING_END,
B51 MAX_SPEED_ZONE_END
"""),
        "GBR": _signs("""
601.1 STOP, 602 YIELD, 632 NO_OVERTAKING_START, 670 MAX_SPEED, 671 MAX_SPEED_END
"""),
        "JPN": _signs("330 STOP, 330-A STOP, 330-B STOP, 330-2 STOP"),
        "NLD": _signs("""
A1 MAX_SPEED, A2 MAX_SPEED_END, B1 PRIORITY, B6 YIELD, B7 STOP, D1 ROUNDABOUT,
F1 NO_OVERTAKING_START, F2 NO_OVERTAKING_END, F8 ALL_MAX_SPEED_AND_OVERTAKING_END
"""),
        "POL": _signs("""
A-7 YIELD, B-20 STOP, B-25 NO_OVERTAKING_START, B-26 NO_OVERTAKING_TRUCKS_START,
B-27 NO_OVERTAKING_END, B-28 NO_OVERTAKING_TRUCKS_END, B-33 MAX_SPEED, B-34 MAX_SPEED_END,
B-42 ALL_MAX_SPEED_AND_OVERTAKING_END, B-43 MAX_SPEED_ZONE_START, B-44 MAX_SPEED_ZONE_END,
C-12 ROUNDABOUT, D-1 PRIORITY
"""),
        "RUS": _signs("""
3.25 MAX_SPEED_END, 3.31 ALL_MAX_SPEED_AND_OVERTAKING_END, 5.31 MAX_SPEED_ZONE_START,
5.32 MAX_SPEED_ZONE_END
"""),
        "SWE": _signs("""
B1 YIELD, B2 STOP, B4 PRIORITY, C27 NO_OVERTAKING_START, C28 NO_OVERTAKING_END, C31 MAX_SPEED,
C32 MAX_SPEED_END, D3 ROUNDABOUT
"""),
        "USA": _signs("R1-2 YIELD, R4-1 NO_OVERTAKING_START"),
    }
)
"""Signs of countries' catalogues that `commonroad-io` does not have, with ids in capitals.

Taken from Belgium's royal decree of 1 December 1975, articles 67 and 69 (B1, B5, B9, B15, D5), the
Swiss Signalisationsverordnung, articles 22, 24, 26 and 36, France's instruction on signs, annex B
(B3, B31, B33) and parts on priority (AB3a, AB4, AB6), the British regulations of 2002, schedule 1
(601.1, 602) and Traffic Signs Manual, chapter 3, appendix B (670), Japan's order on signs (330,
330-2), the Dutch RVV 1990, annex 1 (B6, D1, F1), Poland's regulation of 31 July 2002 (A-7, B-20,
B-25 to B-28, B-33, B-34, B-42 to B-44, D-1), lists of Spanish (R500 to R503), Russian (5.31, 5.32)
and Swedish signs (B1, B2, B4, C31, D3), the MUTCD (R1-2, R4-1), and Australia's AS 1742 (R1-3); the
others are from memory.
"""

CATALOGUED = frozenset({*_COUNTRIES, *_MORE} - {"CHN", "ITA"})
"""The countries, besides Germany, of whose catalogues at least one sign is known here."""

LIMITS_KNOWN = frozenset(
    country
    for table in (_COUNTRIES, _MORE)
    for country, signs in table.items()
    if MAX_SPEED in signs.values()
)
"""Those of them whose sign for a speed limit is known."""

_PLATES = _signs("""
1020-30 ADDITION_RESIDENTS_PERMITTED, 1022-10 ADDITION_BICYCLES_PERMITTED,
1024-10 ADDITION_CARS_PERMITTED, 1026-36 ADDITION_AGRICULTURE_PERMITTED,
1026-37 ADDITION_FOREST_PERMITTED, 1026-38 ADDITION_AGRICULTURE_FOREST_PERMITTED,
1031-52 ADDITION_GREEN_STICKER_PERMITTED, 1040-30 ADDITION_TIME_PERIOD_PERMITTED,
1048-12 ADDITION_MOTOR_VEHICLES_ALLOWED_MASS_3_5_TONS, 1049-13 ADDITION_MIN_MASS_3_5_TONS,
1052-31 ADDITION_NO_WATER_POLLUTANTS_LOADED, 1053-33 ALLOWED_MASS_7_5_TONS,
1053-34 ADDITION_VALID_ON_SHOULDER, 1053-35 ADDITION_VALID_WHEN_WET
""")
_FIRST_PLATE = 226
"""The number of the first plate; a plate says to whom or when the signs above it apply."""

_PLATE = re.compile(r"1\d{3}(?!\d).*", re.ASCII)
_PLATES_OF_PLACE = frozenset({"1001"})
"""Germany's plates that only say for how many metres signs hold."""

_PLATES_OF_WAYS = frozenset({"1000", "1002", "1008"})
"""Germany's plates about directions and who crosses: signs of priority hold all the same."""

_BEGUN: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys((ZONE, "MAX_SPEED_END", "MAX_SPEED_ZONE_END"), MAX_SPEED),
        "ALL_MAX_SPEED_AND_OVERTAKING_END": MAX_SPEED,
        "MIN_SPEED_END": MIN_SPEED,
        "NO_OVERTAKING_END": "NO_OVERTAKING_START",
    }
)

_LATER_IN_USA = ("STOP", "STOP_4_WAY", "NO_TURN_ON_RED", "ONEWAY")


def signs_by_number(country: str) -> dict[int, str]:
    """The names of a country's signs by their numbers in Protocol Buffers."""
    if country in _COUNTRIES:
        later = _LATER_IN_USA if country == "USA" else ()
        names = [name for name in _COUNTRIES[country].values() if name not in later]
        return dict(enumerate(names or [MAX_SPEED]))
    # The numbers skip signs that are not about driving, between the last ones
    *first, crossing, arrow = _GERMANY.values()
    plates = dict(enumerate(_PLATES.values(), _FIRST_PLATE))
    return {**dict(enumerate(first)), 92: crossing, 170: arrow, **plates}


_WITH_UNIT = re.compile(r"(\d{1,3}(?:\.\d{1,3})?) ?(kmh|km/h|mph|m/s)", re.ASCII)
"""A speed limit as written in maps of the INTERACTION dataset, for instance ``80kmh``."""


class Sign(NamedTuple):
    """A sign's name, and the speed limit or minimum speed (m/s) on it, if any.

    ``untold`` is the name of a sign that is there, but holds only for some, at some times, or with
    a number that the file does not give; its ``name`` is then ``UNKNOWN`` if a plate is the reason.
    """

    name: str
    limit_mps: float | None = None
    untold: str = ""


def read_sign(tree: Tree, country: str) -> tuple[Sign, ...]:
    """The signs on a post, by a country's ids (ISO 3166).

    Those are ``UNKNOWN`` of which a plate says for whom or when they apply.
    """
    elements = tree.all("trafficSignElement")
    signs = [_element(child, country) for child in elements]
    plates = [
        _number(child)
        for child, sign in zip(elements, signs, strict=True)
        if sign.name in _PLATES.values() or is_plate(_number(child), country)
    ]
    return tuple([with_plates(sign, plates) for sign in signs])


def is_plate(number: str, country: str) -> bool:
    """Whether the sign with this id (of a country, ISO 3166) is a plate below another sign.

    Germany's ids of plates are those from 1000 on, in files of all countries. Of other countries'
    signs, those that are not known here may be plates.
    """
    if _PLATE.fullmatch(number):
        return True
    known = not country or country not in _COUNTRIES.keys() | _MORE.keys()
    return bool(number) and not known and sign_name(number, country) == UNKNOWN


def with_plates(sign: Sign, plates: Iterable[str]) -> Sign:
    """The sign as plates with these ids below it leave it: untold if one says when it holds."""
    if sign.name == UNKNOWN or not any(_qualifies(number, sign.name) for number in plates):
        return sign
    return Sign(UNKNOWN, untold="" if sign.name in _PLATES.values() else effect_name(sign.name))


def _qualifies(plate: str, name: str) -> bool:
    kind = plate[:4]
    return kind not in _PLATES_OF_PLACE and not (name in REGULATING and kind in _PLATES_OF_WAYS)


def effect_name(name: str) -> str:
    """The name of what a sign begins or ends: a zone is a limit, and so is its end."""
    return _BEGUN.get(name, name)


def _number(tree: Tree) -> str:
    number = tree.first("trafficSignID")
    return "" if number is None else number.word


def _element(tree: Tree, country: str) -> Sign:
    named = tree.first("signName")
    name = sign_name(tree.child("trafficSignID").word, country) if named is None else named.word
    value = tree.first("additionalValue")
    if name not in LIMITS | {MIN_SPEED}:
        return Sign(name)
    return Sign(name, untold=effect_name(name)) if value is None else Sign(name, speed_limit(value))


def sign_name(number: str, country: str) -> str:
    """The name of the sign with this id in a country (ISO 3166).

    ``UNKNOWN`` if it is not listed.
    """
    names = _COUNTRIES.get(country, _GERMANY)
    if number == _GERMAN_MAX_SPEED:
        return MAX_SPEED
    return names.get(number) or _PLATES.get(number) or _more(number, country)


def national_sign(number: str, country: str) -> str:
    """The name of a sign in a country's own catalogue; Germany's if ``country`` is empty."""
    own = not country or country == "DEU" or country in _COUNTRIES
    return sign_name(number, country) if own else _more(number, country)


def _more(number: str, country: str) -> str:
    return _MORE.get(country, {}).get(number.upper(), UNKNOWN)


def speed_limit(tree: Tree) -> float:
    """A speed limit (m/s, or in the unit given); infinity if it says that there is none."""
    if tree.word.lower() in ("inf", "infinity"):
        return inf
    with_unit = _WITH_UNIT.fullmatch(tree.word.lower())
    if with_unit is not None:
        return float(with_unit[1]) * SPEED_UNITS[with_unit[2]]
    limit = tree.number()
    if limit < 0:
        raise tree.wrong(f"a speed limit is {limit:g}", "a number not below 0")
    return limit
