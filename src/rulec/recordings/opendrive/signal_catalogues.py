"""Catalogues of signals, by country and type number.

The standard's catalogue (country ``OpenDRIVE``) has traffic lights and marks on the road. Other
numbers are those of a country's catalogue, by default Germany's.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from types import MappingProxyType

from rulec.recordings.commonroad.countries import country_of
from rulec.recordings.commonroad.traffic_signs import (
    CATALOGUED,
    LIMITS,
    LIMITS_KNOWN,
    MAX_SPEED,
    MIN_SPEED,
    UNKNOWN,
    Sign,
    effect_name,
    is_plate,
    national_sign,
)
from rulec.recordings.encodings.speed_units import MPS_PER_KMH, SPEED_UNITS
from rulec.recordings.opendrive.content.elements import RoadSignal
from rulec.recordings.recording import REGULATING

_LIGHTS = frozenset({"1000001", *(f"10000{number:02}" for number in (8, 9, 10, 11, 12))})
"""Lights for vehicles; others in the catalogue are for pedestrians, cyclists or trams."""

_OTHER_LIGHTS = frozenset(f"10000{number:02}" for number in (2, 7, 13, 14, 15, 16, 17, 18))
WALKERS_LIGHTS = frozenset({"1000002", "1000007"})
CROSSWALK = "1000003"
_STOP_LINE = "294"

_GERMAN = frozenset({"", "DEU", "OPENDRIVE", "OPEN_DRIVE"})

LEAST_SPEED_END = "MIN_SPEED_END"
_MORE_GERMAN: Mapping[str, str] = MappingProxyType({"279": LEAST_SPEED_END})

_NUMBERED = frozenset({*LIMITS, MIN_SPEED})

HOLDS_ON: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        **dict.fromkeys((*_NUMBERED, "NO_OVERTAKING_START"), frozenset()),
        **dict.fromkeys(("NO_OVERTAKING_TRUCKS_START", "TOWN_SIGN"), frozenset()),
        "MAX_SPEED_END": frozenset({MAX_SPEED}),
        "MAX_SPEED_ZONE_END": LIMITS,
        LEAST_SPEED_END: frozenset({MIN_SPEED}),
        "NO_OVERTAKING_END": frozenset({"NO_OVERTAKING_START"}),
        "NO_OVERTAKING_TRUCKS_END": frozenset({"NO_OVERTAKING_TRUCKS_START"}),
        "ALL_MAX_SPEED_AND_OVERTAKING_END": frozenset(
            {MAX_SPEED, "NO_OVERTAKING_START", "NO_OVERTAKING_TRUCKS_START"}
        ),
        "TOWN_SIGN_BACK": frozenset({"TOWN_SIGN"}),
    }
)
"""Signs that apply from their position onward -> the signs whose effect they end."""

PRIORITY_SIGNS = frozenset({"PRIORITY"})
AT_LINE = REGULATING | {
    *("GREEN_ARROW", "NO_TURN_ON_RED", "ROUNDABOUT"),
    *("PRIORITY_OPPOSITE_DIRECTION", "PRIORITY_OVER_ONCOMING"),
}
"""Signs that apply at the end of the lane before them: who goes first, and who may turn on red."""

NO_SIGN = frozenset({"", "-1", "none"})
"""Types of signals that are no signs of a catalogue, such as posts."""


def country_named(code: str) -> str:
    """The code of a country (ISO 3166, three letters); unknown codes are only put in capitals."""
    return country_of(code) or code.upper()


def is_light(signal: RoadSignal, controlled: Collection[str]) -> bool:
    """Whether a signal is a light for vehicles, by the standard's catalogue or a controller."""
    if not signal.dynamic or signal.type in _OTHER_LIGHTS:
        return False
    return signal.type in _LIGHTS or (
        signal.id in controlled and catalogue_sign(signal).name == UNKNOWN
    )


def is_stop_line(signal: RoadSignal) -> bool:
    """Whether a signal is the German sign 294, a stop line."""
    return signal.type == _STOP_LINE and country_named(signal.country) in _GERMAN


def has_catalogue(signal: RoadSignal) -> bool:
    """Whether signs of a signal's country are known here, or it is one of the standard's own."""
    return _is_standard(signal) or country_named(signal.country) in _GERMAN | CATALOGUED


def _is_standard(signal: RoadSignal) -> bool:
    return signal.type.startswith("10000") and len(signal.type) == len(CROSSWALK)


def catalogue_sign(signal: RoadSignal) -> Sign:
    """The sign that a signal is by its number; ``UNKNOWN`` for unknown ones.

    If it is about a speed and its number is not read, it is untold.
    """
    country = country_named(signal.country)
    if signal.type in NO_SIGN or country not in _GERMAN | CATALOGUED:
        return Sign(UNKNOWN)
    name = next((x for x in _names(signal, country) if x != UNKNOWN), UNKNOWN)
    if name not in _NUMBERED:
        return Sign(name)
    limit = _limit(signal, country, name)
    return Sign(name, limit, effect_name(name) if limit is None else "")


def _names(signal: RoadSignal, country: str) -> Iterator[str]:
    numbered = country if country not in _GERMAN else ""
    for number in _numbers(signal):
        yield national_sign(number, numbered)
        if not numbered:
            yield _MORE_GERMAN.get(number, UNKNOWN)


def _numbers(signal: RoadSignal) -> tuple[str, str, str]:
    kind, subtype = _parts(signal)
    return f"{kind}-{subtype}", f"{kind}.{subtype}", kind


def _parts(signal: RoadSignal) -> tuple[str, str]:
    """A signal's type and subtype; some files write the whole German number as the type."""
    kind, parted, subtype = signal.type.partition("-")
    is_whole = bool(kind and parted) and country_named(signal.country) in _GERMAN
    return (kind, subtype) if is_whole else (signal.type, signal.subtype)


def is_german_plate(signal: RoadSignal) -> bool:
    """Whether a signal is a plate of Germany's catalogue, and no sign itself."""
    return country_named(signal.country) in _GERMAN and is_plate(signal.type, "")


def plate_number(signal: RoadSignal) -> str:
    """The number of a plate; empty for other signals.

    Of other countries than Germany, what is not known here may be a plate.
    """
    if country_named(signal.country) in _GERMAN:
        return _numbers(signal)[0] if is_german_plate(signal) else ""
    if signal.type in NO_SIGN or signal.dynamic or signal.has_meaning or signal.board:
        return ""
    known = _is_standard(signal) or catalogue_sign(signal).name != UNKNOWN
    return "" if known else f"?{signal.type}"


def may_limit(signal: RoadSignal) -> bool:
    """Whether a signal that is not known here may begin, change or end a speed limit.

    Where the country's sign for a limit is known, others may only if they have a speed.
    """
    country = country_named(signal.country)
    if signal.type in NO_SIGN or signal.has_meaning or country in _GERMAN or _is_standard(signal):
        return False
    has_speed = signal.value is not None and signal.unit.lower() in SPEED_UNITS
    return has_speed or not (signal.dynamic or country in LIMITS_KNOWN)


def _limit(signal: RoadSignal, country: str, name: str) -> float | None:
    """The speed (m/s) on a sign: its value, or that of its subtype in Germany's catalogue.

    Until 2017, subtypes of 274 counted tens from 51 on; since then they are the limit itself.
    Subtypes that could be either give no limit, and neither do values in another unit.
    """
    if signal.value is not None:
        usual = "mph" if country in ("USA", "GBR") else "km/h"
        unit = SPEED_UNITS.get(signal.unit.lower() or usual)
        return None if unit is None else signal.value * unit
    _, digits = _parts(signal)
    number = int(digits) if digits.isascii() and digits.isdigit() and len(digits) < 4 else 0
    if country not in _GERMAN or name == MIN_SPEED:
        return None
    if name == MAX_SPEED and number in _OLD_LIMITS:
        return (number - 50) * 10 * MPS_PER_KMH
    return number * MPS_PER_KMH if number in _NEW_LIMITS else None


_OLD_LIMITS = frozenset({*range(51, 60), 61, 62, 63})
_NEW_LIMITS = frozenset({5, 10, 20, 30, 40, *range(70, 140, 10)})
"""Subtypes of 274 that only one catalogue has: 60 was 100 km/h, and is 60 km/h now."""
