"""Units of measure as written in rulebooks: `m`, `km/h`, `m/s^2`, `%`.

Names and sizes are Pint's (case matters), with sizes as exact fractions. Common units come from a
table; Pint is loaded only for others.
"""

from __future__ import annotations

import re
from fractions import Fraction

from rulec.vocabulary.dimensions import COMPOSITE, NUMBER, REFUSED, UNITS, Refusal, Unit
from rulec.vocabulary.pint_units import pint_unit

# Pint's longest name has 41 letters; the limits keep hostile input from taking long.
_LONGEST = 64
_HIGHEST_POWER = 9

_RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_FACTOR = re.compile(rf"([^\W\d]\w*?)(?:\^(-?[0-9]+)|([{_RAISED}]+))?")
_FROM_RAISED = str.maketrans(_RAISED, "0123456789")


def parse_unit(text: str) -> Unit | None:
    """Parse a unit: `%`, `°`, or names with integer powers, divided by `/`.

    `a/b/c` is `a/(b*c)`; `m²` is `m^2`. None if the unit is unknown, or known but refused (not an
    exact multiple of base units, or ambiguous); `unit_refusal` then gives the reason.
    """
    read = _read(text)
    return read if isinstance(read, Unit) else None


def unit_refusal(text: str) -> Refusal | None:
    """Why a known unit such as `degC` cannot be used; None if it can, or if it is unknown."""
    read = _read(text)
    return read if isinstance(read, Refusal) else None


def known_unit_names() -> tuple[str, ...]:
    """The common units, for "did you mean"; Pint knows about a thousand more."""
    return (*COMPOSITE, *UNITS)


_KM_AN_HOUR = re.compile("(km|км)/?(t|tim|u|st|std|ч|год)", re.IGNORECASE)
"""km/h where an hour is `time`, `uur` or `Stunde`; `t` and `u` alone are units of mass."""


def hour_in_another_language(text: str) -> str:
    """Help for km/h written with another language's short form of hour, as `km/t`; else empty."""
    return "an hour is `h`: did you mean `km/h`?" if _KM_AN_HOUR.fullmatch(text) else ""


_IN_OTHER_LANGUAGES = {
    "s": "sek sekunde sekund sekunder sekunden sekunnin sekuntia secondes seconde seconden secondi "
    "secondo segundo segundos sekunda sekundy sekund vteřina vteřiny vteřin sec secs "
    "с сек секунда секунды секунд δευτερόλεπτα 秒 초",
    "min": "minutt minutter minuter minuut minuten minuti minuto minutos minuta minuty minut "
    "minuutti minuuttia мин минута минуты минут λεπτά 分钟 分 분",
    "h": "time timer timme timmar std stunde stunden heure heures uur uren ora ore hora horas "
    "godz godzina godziny godzin hodina hodiny hodin tunti tuntia ч час часа часов ώρα ώρες "
    "小时 時間 시간",
    "m": "metri metro metros metr metry metrů metrów metriä mètre mètres м метр метра метров "
    "μέτρα 米 メートル 미터",
    "km": "kilometri kilometro kilometros kilometr kilometry kilometrů kilometrów kilometriä "
    "kilomètre kilomètres км километр километра километров χιλιόμετρα 公里 キロメートル 킬로미터",
    "t": "tonn tonnes tonne tonnen toneladas tonelada tonnellate tona tony ton tuna tuny tun "
    "tonnia т тонна тонны тонн τόνοι 吨 トン 톤",
    "%": "prosent procent prozent pourcent pct percento procento procenta prosenttia",
}
_UNIT_MEANT = {word: unit for unit, words in _IN_OTHER_LANGUAGES.items() for word in words.split()}


def unit_in_another_language(text: str) -> tuple[str, str]:
    """The unit that is written out, in any language: `sekunder`, `km/t`; and help, else empty."""
    if hour := hour_in_another_language(text):
        return "km/h", hour
    unit = _parts_meant(text)
    speed = ", or `km/h` for a speed" if unit == "h" else ""
    return unit, f"did you mean `{unit}`{speed}?" if unit else ""


def _parts_meant(text: str) -> str:
    """The unit with each part that is in another language in this one; empty if there is none."""
    if text.casefold() in _UNIT_MEANT:
        return _UNIT_MEANT[text.casefold()]
    matches = [_FACTOR.fullmatch(part) for part in text.split("/")] if len(text) <= _LONGEST else []
    parts = [
        _UNIT_MEANT.get(match[1].casefold(), match[1]) + match[0][len(match[1]) :]
        for match in matches
        if match is not None
    ]
    meant = "/".join(parts)
    is_whole = len(parts) == len(matches) and meant != text
    return meant if is_whole and parse_unit(meant) is not None else ""


def _read(text: str) -> Unit | Refusal | None:
    if len(text) > _LONGEST:
        return None
    if text in UNITS:  # includes `%` and `°`, which cannot be part of a composed unit
        return UNITS[text]
    dimension, factor = NUMBER, Fraction(1)
    refused: Refusal | None = None
    for place, part in enumerate(text.split("/")):
        match = _FACTOR.fullmatch(part)
        if match is None:
            return None
        unit = _named(match[1])
        if unit is None:
            return None
        power = int(match[2] or (match[3] or "1").translate(_FROM_RAISED))
        if abs(power) > _HIGHEST_POWER:
            why = f"powers of units go from -{_HIGHEST_POWER} to {_HIGHEST_POWER}"
            unit = Refusal(part, why, "write a smaller power")
        if isinstance(unit, Refusal):
            refused = refused or unit
            continue
        signed = -power if place else power
        dimension *= unit.dimension**signed
        factor *= unit.factor**signed
    return refused or Unit(text, dimension, factor)


def _named(name: str) -> Unit | Refusal | None:
    return UNITS.get(name) or REFUSED.get(name) or pint_unit(name)
