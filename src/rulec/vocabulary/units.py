"""Units of measure as rulebooks write them: `m`, `km/h`, `m/s^2`, `%`.

Names and sizes are Pint's (case matters), exact as fractions. The common ones are in a table; Pint
is loaded for the others only.
"""

from __future__ import annotations

import re
from fractions import Fraction

from rulec.vocabulary.dimensions import COMPOSITE, NUMBER, REFUSED, UNITS, Refusal, Unit
from rulec.vocabulary.pint_units import pint_unit

# Pint's longest name has 41 letters; the limits keep hostile texts from costing time.
_LONGEST = 64
_HIGHEST_POWER = 9

_RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_FACTOR = re.compile(rf"([^\W\d]\w*?)(?:\^(-?[0-9]+)|([{_RAISED}]+))?")
_FROM_RAISED = str.maketrans(_RAISED, "0123456789")


def parse_unit(text: str) -> Unit | None:
    """Parse a unit: `%`, `°`, or names with powers and divisions.

    Powers are integers; names are chained by `/`.

    `a/b/c` is `a/(b*c)`; `m²` is `m^2`. None if it is unknown, and if it is known but no exact
    multiple of the base units, or not one unit only; `unit_refusal` then says why.
    """
    read = _read(text)
    return read if isinstance(read, Unit) else None


def unit_refusal(text: str) -> Refusal | None:
    """Reason why a known unit cannot be used (`degC`); otherwise None."""
    read = _read(text)
    return read if isinstance(read, Refusal) else None


def known_unit_names() -> tuple[str, ...]:
    """The common units, for "did you mean"; Pint knows a thousand more."""
    return (*COMPOSITE, *UNITS)


_KM_AN_HOUR = re.compile("km/?(t|tim|u|st|std|ч|год)", re.IGNORECASE)
"""As where an hour is `time`, `uur`, `Stunde`; `t` and `u` alone are units of mass."""


def hour_in_another_language(text: str) -> str:
    """Way out for a unit that says an hour in the letters of another language, as `km/t`."""
    return "an hour is `h`: did you mean `km/h`?" if _KM_AN_HOUR.fullmatch(text) else ""


def _read(text: str) -> Unit | Refusal | None:
    if len(text) > _LONGEST:
        return None
    if text in UNITS:  # also `%` and `°`, which cannot be parts of a chain
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
