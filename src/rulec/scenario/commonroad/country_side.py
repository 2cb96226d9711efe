"""The side of traffic in a scenario's country.

The scenario's name begins with the country's code, ISO 3166.
"""

from __future__ import annotations

from rulec.scenario.recorded.recording import Side

_LEFT = """
AUS BGD BHS BMU BRN BTN BWA CYP FJI GBR GUY HKG IDN IND IRL JAM JPN KEN LKA LSO
MAC MDV MLT MOZ MUS MWI MYS NAM NPL NZL PAK PNG SGP SUR SWZ THA TTO TZA UGA ZAF
ZWE
"""
_RIGHT = """
ALB ARG ARM AUT AZE BEL BGR BIH BLR BRA CAN CHE CHL CHN COL CZE DEU DNK EGY ESP
EST FIN FRA GEO GRC HRV HUN ISL ISR ITA KAZ KOR LTU LUX LVA MAR MDA MEX MNE NLD
NOR PER PHL POL PRT ROU RUS SAU SRB SVK SVN SWE TUN TUR TWN UKR URY USA VNM
"""


def side_in(name: str) -> Side | None:
    """The side of ``DEU_Ulm-1_1_T-1``; None for other names, and for made-up countries.

    CommonRoad's own ``ZAM`` is the made-up country Zamunda, not Zambia.
    """
    country = name.removeprefix("C-").partition("_")[0].upper()
    return "left" if country in _LEFT.split() else "right" if country in _RIGHT.split() else None
