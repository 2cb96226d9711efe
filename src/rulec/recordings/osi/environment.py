"""Country, side of traffic, weather and daylight of an ASAM OSI trace."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rulec.recordings.commonroad.countries import side_in
from rulec.recordings.osi.message_fields import Fields, part
from rulec.recordings.recording import Side, Weather

_COUNTRIES: Mapping[int, str] = {
    int(number): code
    for number, code in (
        pair.split()
        for pair in """
8 ALB, 31 AZE, 32 ARG, 36 AUS, 40 AUT, 44 BHS, 50 BGD, 51 ARM, 56 BEL, 60 BMU, 64 BTN, 70 BIH,
72 BWA, 76 BRA, 96 BRN, 100 BGR, 112 BLR, 124 CAN, 144 LKA, 152 CHL, 156 CHN, 158 TWN, 170 COL,
191 HRV, 196 CYP, 203 CZE, 208 DNK, 233 EST, 242 FJI, 246 FIN, 250 FRA, 268 GEO, 276 DEU, 300 GRC,
328 GUY, 344 HKG, 348 HUN, 352 ISL, 356 IND, 360 IDN, 372 IRL, 376 ISR, 380 ITA, 388 JAM, 392 JPN,
398 KAZ, 404 KEN, 410 KOR, 426 LSO, 428 LVA, 440 LTU, 442 LUX, 446 MAC, 454 MWI, 458 MYS, 462 MDV,
470 MLT, 480 MUS, 484 MEX, 498 MDA, 499 MNE, 504 MAR, 508 MOZ, 516 NAM, 524 NPL, 528 NLD, 554 NZL,
578 NOR, 586 PAK, 598 PNG, 604 PER, 608 PHL, 616 POL, 620 PRT, 642 ROU, 643 RUS, 682 SAU, 688 SRB,
702 SGP, 703 SVK, 704 VNM, 705 SVN, 710 ZAF, 716 ZWE, 724 ESP, 740 SUR, 748 SWZ, 752 SWE, 756 CHE,
764 THA, 780 TTO, 788 TUN, 792 TUR, 800 UGA, 804 UKR, 818 EGY, 826 GBR, 834 TZA, 840 USA, 858 URY
""".replace("\n", " ").split(",")
    )
}
"""ISO 3166-1 numeric code -> alpha-3 code, for countries whose side of traffic is known."""

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


def country_of(number: int) -> tuple[str, Side | None]:
    """A country's alpha-3 code and its side of traffic.

    Empty and None for 0 or an unlisted number.
    """
    code = _COUNTRIES.get(number, "")
    return code, side_in(code) if code else None


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
