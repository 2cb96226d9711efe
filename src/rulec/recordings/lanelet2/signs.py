"""Traffic signs of Lanelet2 maps, with the names used in recordings."""

from __future__ import annotations

import re

from rulec.recordings.commonroad.traffic_signs import (
    CATALOGUED,
    MAX_SPEED,
    UNKNOWN,
    Sign,
    national_sign,
)
from rulec.recordings.lanelet2.lane_tags import velocity
from rulec.recordings.lanelet2.region_codes import sign_parts

AUTOWARE_SIGNS = {"stop_sign": "STOP", "yield_sign": "YIELD"}
"""Names of signs that do not depend on a country."""

_GERMAN_LIMIT = re.compile(r"de[ _:-]?274[-_](\d{1,3})$", re.IGNORECASE)


def sign_of(kind: str) -> Sign:
    """The sign named by a subtype or ``sign_type``; ``UNKNOWN`` for signs not about driving.

    `de274-50` is the limit of 50 km/h, and so is `50 km/h` in place of a sign's name.
    """
    if kind in AUTOWARE_SIGNS:
        return Sign(AUTOWARE_SIGNS[kind])
    if (limit := _GERMAN_LIMIT.match(kind)) is not None and int(limit[1]) > 1:
        return Sign(MAX_SPEED, int(limit[1]) / 3.6)
    country, number = sign_parts(kind)
    if country and country not in CATALOGUED | {"DEU"}:
        return Sign(UNKNOWN)
    if country:
        spelled = (number, number.replace("_", "-"), number.replace("_", "."))
        tried = (*spelled, *(word.upper() for word in spelled))
        names = (national_sign(word, country) for word in tried)
        return Sign(next((name for name in names if name != UNKNOWN), UNKNOWN))
    speed = velocity(kind)
    return Sign(UNKNOWN) if speed is None else Sign(MAX_SPEED, speed)
