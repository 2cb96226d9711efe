"""Dimensions and units, with exact factors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Dimension:
    """Physical dimension: a product of powers of base dimensions.

    Length × 1/time is speed, the empty product a number.

    ``exponents`` are pairs of a base dimension and its power, in any order; they are kept sorted,
    one for each base and none of zero, so that equal dimensions are equal values.
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
        """``Dimension.of(length=1, time=-1)`` is speed."""
        return cls(tuple(powers.items()))

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(self.exponents + other.exponents)

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other**-1

    def __pow__(self, power: int) -> Dimension:
        return Dimension(tuple((base, own * power) for base, own in self.exponents))

    @property
    def name(self) -> str:
        """In words: ``speed``; if it has none, as units are written: ``length^2/time``."""
        named = _NAMES.get(self)
        if named is not None:
            return named
        above = [_power(base, power) for base, power in self.exponents if power > 0]
        below = [_power(base, -power) for base, power in self.exponents if power < 0]
        return "/".join(["*".join(above) or "1", *below])


def _power(base: str, power: int) -> str:
    return base if power == 1 else f"{base}^{power}"


NUMBER = Dimension()
LENGTH = Dimension.of(length=1)
TIME = Dimension.of(time=1)
MASS = Dimension.of(mass=1)
# Angles in degrees and angles in radians are two dimensions: the ratio, π/180, is no fraction, and
# numbers of rulebooks are compared exactly.
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
"""The names of dimensions that a rulebook may write."""

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
    """Unit as written, with its exact size in base units.

    The base units are metre, second, kilogram, degree (radian for angles in radians), kelvin,
    ampere, mole, candela, bit and pixel.
    """

    text: str
    dimension: Dimension
    factor: Fraction

    def ratio(self, unit: Unit) -> Fraction:
        """The factor from this unit to ``other``: 5/18 for km/h and m/s.

        Raises:
            ValueError: the units measure different dimensions.
        """
        if self.dimension != unit.dimension:
            measures = f"{self.dimension.name}, {unit.text} {unit.dimension.name}"
            raise ValueError(f"{self.text} measures {measures}")
        return self.factor / unit.factor


@dataclass(frozen=True, slots=True)
class Refusal:
    """Reason why a known unit is refused, and its replacement."""

    text: str
    why: str
    instead: str
