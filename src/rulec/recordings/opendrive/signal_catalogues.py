"""Catalogues of signals, by country and type number.

The standard's catalogue (country ``OpenDRIVE``) has traffic lights and marks on the road. Other
numbers are those of a country's catalogue, by default Germany's.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType

from rulec.recordings.commonroad.traffic_signs import CATALOGUED, UNKNOWN, Sign, national_sign
from rulec.recordings.encodings.speed_units import KMH, SPEED_UNITS
from rulec.recordings.opendrive.content.elements import RoadSignal

_LIGHTS = frozenset({"1000001", *(f"10000{number:02}" for number in (8, 9, 10, 11, 12))})
"""Lights for vehicles; others in the catalogue are for pedestrians, cyclists or trams."""

_OTHER_LIGHTS = frozenset(f"10000{number:02}" for number in (2, 7, 13, 14, 15, 16, 17, 18))
WALKERS_LIGHTS = frozenset({"1000002", "1000007"})
CROSSWALK = "1000003"
_STOP_LINE = "294"

_CODES: Mapping[str, str] = MappingProxyType(
    {
        "US": "USA",
        "ES": "ESP",
        "AU": "AUS",
        "RU": "RUS",
        "AR": "ARG",
        "BE": "BEL",
        "FR": "FRA",
        "GR": "GRC",
        "HR": "HRV",
        "CN": "CHN",
        "IT": "ITA",
        "DE": "DEU",
        "GB": "GBR",
        "SE": "SWE",
        "AT": "AUT",
        "CH": "CHE",
        "NL": "NLD",
        "JP": "JPN",
        "PL": "POL",
        "GERMANY": "DEU",
    }
)
"""Countries' codes of two letters, which the standard uses since 1.6 -> those of three letters."""

_GERMAN = frozenset({"", "DEU", "OPENDRIVE", "OPEN_DRIVE"})

HOLDS_ON: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "MAX_SPEED": frozenset(),
        "NO_OVERTAKING_START": frozenset(),
        "MAX_SPEED_END": frozenset({"MAX_SPEED"}),
        "NO_OVERTAKING_END": frozenset({"NO_OVERTAKING_START"}),
        "ALL_MAX_SPEED_AND_OVERTAKING_END": frozenset({"MAX_SPEED", "NO_OVERTAKING_START"}),
    }
)
"""Signs that apply from their position onward -> the signs whose effect they end."""

PRIORITY_SIGNS = frozenset({"PRIORITY"})


def country_of(code: str) -> str:
    """The code of a country (ISO 3166, three letters); unknown codes are only put in capitals."""
    return _CODES.get(code.upper(), code.upper())


def is_light(signal: RoadSignal, controlled: Collection[str]) -> bool:
    """Whether a signal is a light for vehicles, by the standard's catalogue or a controller."""
    if not signal.dynamic or signal.type in _OTHER_LIGHTS:
        return False
    return signal.type in _LIGHTS or (signal.id in controlled and sign_of(signal) is None)


def is_stop_line(signal: RoadSignal) -> bool:
    """Whether a signal is the German sign 294, a stop line."""
    return signal.type == _STOP_LINE and country_of(signal.country) in _GERMAN


def sign_of(signal: RoadSignal) -> Sign | None:
    """The sign that a signal shows; None for unknown and for variable ones."""
    country = country_of(signal.country)
    if signal.dynamic or not signal.type or signal.type in ("-1", "none"):
        return None
    if country not in _GERMAN | CATALOGUED:
        return None
    numbered = country if country not in _GERMAN else ""
    whole = f"{signal.type}-{signal.subtype}"
    for number in (whole, f"{signal.type}.{signal.subtype}", signal.type):
        name = national_sign(number, numbered)
        if name != UNKNOWN:
            return Sign(name, _limit(signal, country) if name == "MAX_SPEED" else None)
    return None


def _limit(signal: RoadSignal, country: str) -> float | None:
    """The limit (m/s) on a sign: its value, or that of its subtype in Germany's catalogue.

    Until 2017, subtypes counted tens from 51 on; since then they are the limit itself. Subtypes
    that could be either give no limit.
    """
    if signal.value is not None:
        unit = signal.unit or ("mph" if country in ("USA", "GBR") else "km/h")
        return signal.value * SPEED_UNITS.get(unit, KMH)
    digits = signal.subtype if signal.subtype.isascii() and signal.subtype.isdigit() else ""
    number = int(digits) if 0 < len(digits) < 4 else 0
    if country in _GERMAN and 51 <= number <= 59:
        return (number - 50) * 10 * KMH
    return number * KMH if country in _GERMAN and number in (10, 20, 30, 40) else None
