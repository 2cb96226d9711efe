"""Dimensions, units with exact factors, and a table of the units that rulebooks usually need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Dimension:
    """Physical dimension: a product of powers of base dimensions.

    Speed is length × 1/time; a plain number is the empty product.

    ``exponents`` are pairs of a base dimension and its power, in any order. They are stored sorted,
    with one pair per base and no zero powers, so that equal dimensions compare equal.
    """

    exponents: tuple[tuple[str, int], ...] = ()

    def __post_init__(self) -> None:
        powers: dict[str, int] = {}
        for base, power in self.exponents:
            powers[base] = powers.get(base, 0) + power
        kept = tuple(sorted((base, power) for base, power in powers.items() if power))
        object.__setattr__(self, "exponents", kept)

    @classmethod
    def of(cls, **powers: int) -> Dimension:
        """The dimension with these powers: ``Dimension.of(length=1, time=-1)`` is speed."""
        return cls(tuple(powers.items()))

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(self.exponents + other.exponents)

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other**-1

    def __pow__(self, power: int) -> Dimension:
        return Dimension(tuple((base, own * power) for base, own in self.exponents))

    @property
    def name(self) -> str:
        """Its English name (``speed``), or a formula such as ``length^2/time`` if it has none."""
        if self in _NAMES:
            return _NAMES[self]
        above = [_power(base, power) for base, power in self.exponents if power > 0]
        below = [_power(base, -power) for base, power in self.exponents if power < 0]
        return "/".join(["*".join(above) or "1", *below])


def _power(base: str, power: int) -> str:
    return base if power == 1 else f"{base}^{power}"


NUMBER = Dimension()
LENGTH = Dimension.of(length=1)
TIME = Dimension.of(time=1)
MASS = Dimension.of(mass=1)
# Angles in degrees and in radians are two dimensions: their ratio, π/180, is irrational, and
# numbers in rulebooks are compared exactly.
ANGLE = Dimension.of(angle=1)
ANGLE_IN_RADIANS = Dimension.of(radian=1)
SPEED = LENGTH / TIME
ACCELERATION = SPEED / TIME
FREQUENCY = NUMBER / TIME
AREA = LENGTH**2

DIMENSIONS: Mapping[str, Dimension] = MappingProxyType(
    {
        "number": NUMBER,
        "length": LENGTH,
        "distance": LENGTH,
        "time": TIME,
        "duration": TIME,
        "speed": SPEED,
        "acceleration": ACCELERATION,
        "mass": MASS,
        "angle": ANGLE,
        "area": AREA,
        "frequency": FREQUENCY,
    }
)
"""The names of dimensions that can be used in a rulebook."""

_NAMES: dict[Dimension, str] = {
    # `distance` and `duration` come second, so that the names shown are `length` and `time`.
    **{dimension: name for name, dimension in reversed([*DIMENSIONS.items()])},
    ANGLE_IN_RADIANS: "angle in radians",
    ANGLE / TIME: "angular speed",
    ACCELERATION / TIME: "jerk",
    LENGTH**3: "volume",
    MASS * ACCELERATION: "force",
    MASS * SPEED**2: "energy",
    MASS * SPEED**2 / TIME: "power",
    MASS * ACCELERATION / AREA: "pressure",
}


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as written, with its exact size in base units.

    The base units are metre, second, kilogram, degree (radian for angles in radians), kelvin,
    ampere, mole, candela, bit and pixel.
    """

    text: str
    dimension: Dimension
    factor: Fraction


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a known unit cannot be used, and what to write instead."""

    text: str
    why: str
    instead: str


# Pint's spellings and sizes (a test compares every row with Pint). With this table, reading `km/h`
# does not load Pint and its registry, which takes a quarter of a second.
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
"""Common unit names without powers or divisions -> the unit."""

COMPOSITE = ("km/h", "m/s", "m/s^2", "ft/s")
"""Composed units, suggested when an unknown unit looks like a typing error."""

_TON = (
    "a ton is 1000 kg, 2000 lb or 2240 lb, depending on the country",
    "write `t` (1000 kg), `short_ton` (2000 lb) or `long_ton` (2240 lb)",
)

REFUSED: Mapping[str, Refusal] = MappingProxyType(
    {name: Refusal(name, *_TON) for name in ("ton", "tons")}
)
"""Unit names that mean different sizes to different readers."""
