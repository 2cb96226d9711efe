"""The countries in Lanelet2's tag `region` and in names of traffic signs."""

from __future__ import annotations

_CODES = """
ad AND ae ARE al ALB ar ARG am ARM at AUT au AUS az AZE ba BIH bd BGD be BEL bg BGR bh BHR bn BRN
br BRA bs BHS bt BTN bw BWA by BLR ca CAN ch CHE cl CHL cn CHN co COL cy CYP cz CZE de DEU dk DNK
ee EST eg EGY es ESP fi FIN fj FJI fr FRA gb GBR ge GEO gr GRC hk HKG hr HRV hu HUN id IDN ie IRL
il ISR in IND is ISL it ITA jm JAM jp JPN ke KEN kr KOR kw KWT kz KAZ lk LKA lt LTU lu LUX lv LVA
ma MAR md MDA me MNE mk MKD mo MAC mt MLT mu MUS mw MWI mx MEX my MYS mz MOZ na NAM nl NLD no NOR
np NPL nz NZL om OMN pe PER ph PHL pk PAK pl POL pt PRT qa QAT ro ROU rs SRB ru RUS sa SAU se SWE
sg SGP si SVN sk SVK th THA tn TUN tr TUR tt TTO tw TWN tz TZA ua UKR ug UGA uk GBR us USA uy URY
vn VNM za ZAF zm ZMB zw ZWE
"""
_WORDS = _CODES.split()
_LONG = dict(zip(_WORDS[::2], _WORDS[1::2], strict=True))


def country_of(region: str) -> str:
    """The three-letter code (ISO 3166) of a region such as `de` or `us-ca`; empty if unknown."""
    return _LONG.get(region[:2].lower(), "") if len(region) == 2 or region[2:3] == "-" else ""


def sign_parts(kind: str) -> tuple[str, str]:
    """The country and number in a sign's name such as `de206`; empty for other names."""
    number = kind[2:].lstrip("_-: ")
    country = _LONG.get(kind[:2].lower(), "")
    return (country, number) if country and number else ("", "")
