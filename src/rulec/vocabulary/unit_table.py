"""The units that rulebooks normally use, spelled as Pint spells them.

They are here so that reading `km/h` does not take loading Pint and its registry, a quarter of a
second. Every row equals what Pint says; a test compares them.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType

from rulec.vocabulary.dimensions import (
    ANGLE,
    ANGLE_IN_RADIANS,
    FREQUENCY,
    LENGTH,
    MASS,
    NUMBER,
    SPEED,
    TIME,
    Dimension,
    Refusal,
    Unit,
)

_ROWS: tuple[tuple[Dimension, str, str], ...] = (
    (LENGTH, "1", "m meter meters metre metres"),
    (LENGTH, "1000", "km kilometer kilometers kilometre kilometres"),
    (LENGTH, "0.1", "dm"),
    (LENGTH, "0.01", "cm centimeter centimeters centimetre centimetres"),
    (LENGTH, "0.001", "mm millimeter millimeters millimetre millimetres"),
    (LENGTH, "0.0254", "in inch inches"),
    (LENGTH, "0.3048", "ft foot feet"),
    (LENGTH, "0.9144", "yd yard yards"),
    (LENGTH, "1609.344", "mi mile miles"),
    (LENGTH, "1852", "nmi"),
    (TIME, "1", "s sec second seconds"),
    (TIME, "0.001", "ms millisecond milliseconds"),
    (TIME, "60", "min minute minutes"),
    (TIME, "3600", "h hr hour hours"),
    (TIME, "86400", "d day days"),
    (TIME, "604800", "week weeks"),
    (SPEED, "1", "mps"),
    (SPEED, "5/18", "kph"),
    (SPEED, "0.44704", "mph"),
    (SPEED, "0.3048", "fps"),
    (SPEED, "463/900", "kt knot knots"),
    (MASS, "0.001", "g gram grams"),
    (MASS, "1", "kg kilogram kilograms"),
    (MASS, "1000", "t tonne tonnes"),
    (MASS, "0.45359237", "lb pound pounds"),
    (ANGLE, "1", "° deg degree degrees"),
    (ANGLE_IN_RADIANS, "1", "rad radian radians"),
    (NUMBER, "0.01", "% percent"),
    (NUMBER, "0.001", "permille"),
    (FREQUENCY, "1", "Hz hertz"),
)

UNITS: Mapping[str, Unit] = MappingProxyType(
    {
        name: Unit(name, dimension, Fraction(factor))
        for dimension, factor, names in _ROWS
        for name in names.split()
    }
)
"""The common units without powers and divisions, by the name."""

COMPOSITE = ("km/h", "m/s", "m/s^2", "ft/s")
"""Composed units that people most often mean when they mistype one."""

_TON = (
    "a ton is 1000 kg, 2000 lb or 2240 lb, according to the country",
    "write `t` (1000 kg), `short_ton` (2000 lb) or `long_ton` (2240 lb)",
)

REFUSED: Mapping[str, Refusal] = MappingProxyType(
    {name: Refusal(name, *_TON) for name in ("ton", "tons")}
)
"""Names that mean different units to different readers."""
