"""Decimal numbers that keep their exact value even where no float represents them.

A float represents the decimal that Python prints for it: the shortest one nearest to it. Most
numbers in files are such decimals.
"""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction
from typing import Any

_FEW_DIGITS = 15
"""A decimal with no more digits is what Python prints for its float, unless huge or tiny."""

_MOST_DIGITS = 1000
"""Largest number of digits, and of decimal places before the first digit, that is read exactly."""


class WrittenNumber(float):
    """A number that no float represents: its ``exact`` value and, as a float, the nearest one.

    It equals integers, fractions and its like of the same exact value, but never a plain float.
    """

    __slots__ = ("exact", "text")
    exact: Fraction
    text: str

    def __new__(cls, exact: Fraction, text: str = "") -> WrittenNumber:
        """The number, with the text it was written as, if any. OverflowError if it is too large."""
        self = super().__new__(cls, exact)
        self.exact = exact
        self.text = text or float.__repr__(self)
        return self

    def __repr__(self) -> str:
        return self.text

    __str__ = __repr__

    def __reduce__(self) -> tuple[Any, ...]:
        return WrittenNumber, (self.exact, self.text)

    def __hash__(self) -> int:
        return hash(self.exact)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, int | Fraction | WrittenNumber):
            return bool(self.exact == _exact(other))
        return False

    def __ne__(self, other: object) -> bool:
        return not self == other  # float's own would compare the nearest floats

    def __lt__(self, other: Any) -> bool:
        return bool(self.exact < _exact(other))

    def __le__(self, other: Any) -> bool:
        return bool(self.exact <= _exact(other))

    def __gt__(self, other: Any) -> bool:
        return bool(self.exact > _exact(other))

    def __ge__(self, other: Any) -> bool:
        return bool(self.exact >= _exact(other))

    def __neg__(self) -> WrittenNumber:
        return WrittenNumber(-self.exact, self.text[1:] if self.text[0] == "-" else f"-{self.text}")

    @property
    def neighbours(self) -> tuple[float, float]:
        """The two adjacent floats whose decimals enclose this number."""
        near = float(self)
        if _exact(near) < self.exact:
            return near, math.nextafter(near, math.inf)
        return math.nextafter(near, -math.inf), near


def _exact(number: Any) -> Any:
    if isinstance(number, WrittenNumber):
        return number.exact
    if isinstance(number, float) and math.isfinite(number):
        return Fraction(float.__repr__(number))
    return number


def number_of(exact: Fraction) -> float:
    """The number with this exact value. OverflowError if it is too large."""
    number = float(exact)
    return number if Fraction(float.__repr__(number)) == exact else WrittenNumber(exact)


def number_written(text: str) -> float:
    """The number that a decimal text represents; infinite if it is too large.

    Raises ValueError if it has too many digits or is too close to 0.
    """
    number = float(text)
    if len(text) <= _FEW_DIGITS and "e" not in text and "E" not in text:
        return number
    if not math.isfinite(number):
        return number
    decimal = Decimal(text)
    if decimal == Decimal(float.__repr__(number)):
        return number
    if len(text) > _MOST_DIGITS or decimal.adjusted() < -_MOST_DIGITS:
        shown = text if len(text) <= 40 else f"{text[:40]}…"
        raise ValueError(f"the number {shown} has too many digits, or is too near to 0")
    return WrittenNumber(Fraction(decimal), text)
