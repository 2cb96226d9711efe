"""Weather and daylight of an ASAM OSI trace."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rulec.recordings.encodings.wire_format import Fields
from rulec.recordings.osi.message_fields import part
from rulec.recordings.recording import Weather

_RAIN = frozenset({"light", "moderate", "heavy", "very_heavy", "extreme"})
_FALLS: Mapping[str, bool] = {"none": False, "very_light": True, **dict.fromkeys(_RAIN, True)}
_DARK: Mapping[str, bool] = {
    **dict.fromkeys(("level1", "level2", "level3", "level4"), True),
    **dict.fromkeys(("level8", "level9"), False),
}
"""Ambient light level -> dark: true below 10 lx, false from 1,000 lx.

Between, it may be overcast.
"""

_FAR = frozenset({"excellent", "good", "moderate", "poor", "mist"})
_FAR_M = 1000.0
"""The standard calls it fog below 1000 m of visibility; lighter haze has levels of its own."""


def weather_of(environment: Fields, lanes: Iterable[Fields]) -> Weather:
    """The weather: wet if it rains or any lane has water on it, icy if any lane has ice.

    It is dry, or free of ice, only if all lanes with surface data say so.
    """
    roads = [part(lane, "classification", "road_condition") for lane in lanes]
    water = [road["surface_water_film"] for road in roads if "surface_water_film" in road]
    ice = [road["surface_ice"] for road in roads if "surface_ice" in road]
    rain = environment.get("precipitation", "unknown")
    wet = any(film > 0 for film in water) if water else None
    if rain in _RAIN:
        wet = True
    icy = any(part > 0 for part in ice) if ice else None
    return Weather(
        wet,
        icy,
        _FAR_M if environment.get("fog") in _FAR else None,
        raining=_FALLS.get(rain),
        night=_DARK.get(environment.get("ambient_illumination", "unknown")),
    )
