"""Units that are not in the table of common ones, read exactly from the Pint library."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rulec.vocabulary.dimensions import REFUSED, Dimension, Refusal, Unit

if TYPE_CHECKING:
    from pint import UnitRegistry

# Pint rounds these to 50 digits. Defined as root units, they remain visible in every unit derived
# from them, so that a rounded size cannot pass for an exact one.
_IRRATIONAL = ("pi", "tansec", "ln10", "wien_x", "wien_u", "eulers_number")

_BASES = {
    "meter": "length",
    "second": "time",
    "gram": "mass",
    "radian": "radian",
    "kelvin": "temperature",
    "ampere": "current",
    "mole": "substance",
    "candela": "luminosity",
    "bit": "information",
    "pixel": "pixels",
}
_INEXACT = (
    "its size is not a fraction of base units such as metres and seconds, so it cannot be exact",
    "write the number in another unit",
)
_PLAIN_NUMBERS = ("count", "refractive_index_unit", "absorbance_unit")


@lru_cache(maxsize=256)
def pint_unit(name: str) -> Unit | Refusal | None:
    """Pint's unit ``name``, a name without powers or divisions; None if Pint does not know it.

    A Refusal if Pint knows it but it is not an exact multiple of base units.
    """
    registry = _registry()
    if registry is None:
        return None
    readings = registry.parse_unit_name(name)
    if not readings:
        return None
    prefix, base_name, _plural = readings[0]
    if prefix and base_name in REFUSED:
        return Refusal(name, REFUSED[base_name].why, REFUSED[base_name].instead)
    try:
        zero_units, single, double = (
            registry.Quantity(Fraction(n), name).to_root_units() for n in (0, 1, 2)
        )
    except Exception:
        # Each kind of scale fails differently: logarithms, for example, do not accept fractions.
        return _no_multiple(name)
    factor: Any = single.magnitude
    if not isinstance(factor, Fraction) or zero_units.magnitude or double.magnitude != 2 * factor:
        return _no_multiple(name)
    return _exact(name, factor, dict(single.unit_items()))


@lru_cache(maxsize=1)
def _registry() -> UnitRegistry[Any] | None:
    """Pint's registry of units; None if Pint is missing or broken."""
    try:
        import pint  # 0.2 s, only for rare units

        registry: UnitRegistry[Any] = pint.UnitRegistry(
            None, non_int_type=Fraction, on_redefinition="ignore"
        )
        registry.load_definitions(Path(pint.__file__).with_name("default_en.txt"))
        for constant in _IRRATIONAL:
            registry.define(f"{constant} = [{constant}]")
    except Exception:  # an installation can be broken in any way
        return None
    return registry


def _no_multiple(name: str) -> Refusal:
    why = "its scale is logarithmic or has its own zero point, so it is no multiple of another unit"
    return Refusal(name, why, "use a unit on an absolute scale, such as `K` for temperatures")


def _exact(name: str, factor: Fraction, roots: dict[str, Any]) -> Unit | Refusal:
    """The unit of size ``factor`` × powers of Pint's ``roots``, converted to base units."""
    powers = {root: Fraction(power) for root, power in roots.items()}
    for number in _PLAIN_NUMBERS:
        powers.pop(number, None)
    exponents: dict[str, int] = {}
    turned = powers.pop("pi", Fraction(0))
    if turned and turned == powers.get("radian"):  # π rad is 180 degrees
        del powers["radian"]
        if turned.denominator == 1:
            factor *= Fraction(180) ** turned.numerator
            exponents["angle"] = turned.numerator
            turned = Fraction(0)
    if turned or any(n.denominator != 1 or root not in _BASES for root, n in powers.items()):
        return Refusal(name, *_INEXACT)
    for root, power in powers.items():
        exponents[_BASES[root]] = power.numerator
    if "gram" in powers:
        factor /= Fraction(1000) ** powers["gram"].numerator
    return Unit(name, Dimension(tuple(exponents.items())), factor)
