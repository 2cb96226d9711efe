"""Countries by their codes (ISO 3166), and the side of traffic in each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rulec.recordings.recording import Side

LEFT_HAND = """
AUS/AU/036 BGD/BD/050 BHS/BS/044 BMU/BM/060 BRN/BN/096 BTN/BT/064 BWA/BW/072 CYP/CY/196 FJI/FJ/242
GBR/GB/826 GUY/GY/328 HKG/HK/344 IDN/ID/360 IND/IN/356 IRL/IE/372 JAM/JM/388 JPN/JP/392 KEN/KE/404
LKA/LK/144 LSO/LS/426 MAC/MO/446 MDV/MV/462 MLT/MT/470 MOZ/MZ/508 MUS/MU/480 MWI/MW/454 MYS/MY/458
NAM/NA/516 NPL/NP/524 NZL/NZ/554 PAK/PK/586 PNG/PG/598 SGP/SG/702 SUR/SR/740 SWZ/SZ/748 THA/TH/764
TTO/TT/780 TZA/TZ/834 UGA/UG/800 ZAF/ZA/710 ZMB/ZM/894 ZWE/ZW/716
"""
RIGHT_HAND = """
ALB/AL/008 AND/AD/020 ARE/AE/784 ARG/AR/032 ARM/AM/051 AUT/AT/040 AZE/AZ/031 BEL/BE/056 BGR/BG/100
BHR/BH/048 BIH/BA/070 BLR/BY/112 BRA/BR/076 CAN/CA/124 CHE/CH/756 CHL/CL/152 CHN/CN/156 COL/CO/170
CZE/CZ/203 DEU/DE/276 DNK/DK/208 EGY/EG/818 ESP/ES/724 EST/EE/233 FIN/FI/246 FRA/FR/250 GEO/GE/268
GRC/GR/300 HRV/HR/191 HUN/HU/348 ISL/IS/352 ISR/IL/376 ITA/IT/380 KAZ/KZ/398 KOR/KR/410 KWT/KW/414
LTU/LT/440 LUX/LU/442 LVA/LV/428 MAR/MA/504 MDA/MD/498 MEX/MX/484 MKD/MK/807 MNE/ME/499 NLD/NL/528
NOR/NO/578 OMN/OM/512 PER/PE/604 PHL/PH/608 POL/PL/616 PRT/PT/620 QAT/QA/634 ROU/RO/642 RUS/RU/643
SAU/SA/682 SRB/RS/688 SVK/SK/703 SVN/SI/705 SWE/SE/752 TUN/TN/788 TUR/TR/792 TWN/TW/158 UKR/UA/804
URY/UY/858 USA/US/840 VNM/VN/704
"""
"""Countries with left-hand and with right-hand traffic: codes alpha-3, alpha-2 and numeric."""

_BY_SIDE: tuple[tuple[Side, str], ...] = (("left", LEFT_HAND), ("right", RIGHT_HAND))
_SIDES = {entry[:3]: side for side, entries in _BY_SIDE for entry in entries.split()}
_CODES = {
    code: entry[:3] for entry in (LEFT_HAND + RIGHT_HAND).split() for code in entry.split("/")[1:]
} | {"UK": "GBR", "GERMANY": "DEU"}

PLACES: Mapping[str, str] = {"singapore": "SGP", "sg-": "SGP", "boston": "USA", "us-": "USA"}
"""How data sets' names of places begin -> the country."""


def country_of(code: str) -> str:
    """The alpha-3 code of a country by its alpha-2 or numeric code; empty if it is not listed."""
    return _CODES.get(code.upper(), "")


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
    return _SIDES.get(country)


def country_at(names: Iterable[str]) -> str:
    """The country of the first name that begins in a known way; empty if none does."""
    known = (PLACES[x] for name in names for x in PLACES if name.lower().startswith(x))
    return next(known, "")
