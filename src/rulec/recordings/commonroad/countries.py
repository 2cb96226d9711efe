"""The side of traffic in the countries that names of CommonRoad scenarios begin with."""

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
"""The codes (ISO 3166) of countries with left-hand and with right-hand traffic."""


def country_in(name: str) -> str:
    """The country code in a scenario's name, such as DEU in ``DEU_Ulm-1_1_T-1``.

    Names of cooperative scenarios have ``C-`` before it. It is empty if the name begins with no
    code, as in ``following``.
    """
    code, parted, _ = name.removeprefix("C-").partition("_")
    return code.upper() if parted and len(code) == 3 and code.isalpha() else ""


def side_in(country: str) -> Side | None:
    """The side of traffic in a country; None for unknown and fictitious ones.

    CommonRoad's ``ZAM`` is the fictitious country Zamunda, not Zambia.
    """
    if country in LEFT_HAND.split():
        return "left"
    return "right" if country in RIGHT_HAND.split() else None
