"""On which side the countries of CommonRoad's names drive."""

from __future__ import annotations

from rulec.recordings.recording import Side

LEFT_HAND = """
AUS BGD BHS BMU BRN BTN BWA CYP FJI GBR GUY HKG IDN IND IRL JAM JPN KEN LKA LSO
MAC MDV MLT MOZ MUS MWI MYS NAM NPL NZL PAK PNG SGP SUR SWZ THA TTO TZA UGA ZAF
ZWE
"""
RIGHT_HAND = """
ALB ARG ARM AUT AZE BEL BGR BIH BLR BRA CAN CHE CHL CHN COL CZE DEU DNK EGY ESP
EST FIN FRA GEO GRC HRV HUN ISL ISR ITA KAZ KOR LTU LUX LVA MAR MDA MEX MNE NLD
NOR PER PHL POL PRT ROU RUS SAU SRB SVK SVN SWE TUN TUR TWN UKR URY USA VNM
"""
"""The codes of countries (ISO 3166) by the side of traffic; names of scenarios begin with them."""


def country_in(name: str) -> str:
    """The code of ``DEU_Ulm-1_1_T-1``, and of ``C-DEU_Ulm-1_1_S-1``, which is cooperative."""
    return name.removeprefix("C-").partition("_")[0].upper()


def side_in(name: str) -> Side | None:
    """The side of a scenario's country; None for other names, and for made-up countries.

    CommonRoad's own ``ZAM`` is the made-up country Zamunda, not Zambia.
    """
    country = country_in(name)
    if country in LEFT_HAND.split():
        return "left"
    return "right" if country in RIGHT_HAND.split() else None
