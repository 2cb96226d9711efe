"""Numbers as decimals, and the thresholds that they pass."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import inf, nextafter

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.logic.formula import Comparison, Proposition, QuantityTerm
from rulec.logic.free_names import names_in, variables_of
from rulec.trace import Value
from rulec.vocabulary.written_numbers import WrittenNumber

EXACT_IN_FLOATS = 1 << 53
"""Whole numbers up to this size are floats, too, and their decimals are themselves."""


def exact(value: Fraction | float) -> Fraction:
    """Exact value of a decimal: 0.1 is a tenth, not a float."""
    if type(value) is WrittenNumber:
        return value.exact
    return _decimal(value) if isinstance(value, float) else Fraction(value)


@lru_cache(maxsize=1 << 8)
def exact_step(step_s: Fraction | float) -> Fraction:
    """The exact step (s) that a number stands for.

    Frame rates have steps that no decimal is: one that rounds a whole number of frames a second, or
    a thousand of them in 1001 s as video has, to five digits or more means that.
    """
    step = exact(step_s)
    digits = str(step_s).partition("e")[0].replace(".", "").lstrip("0")
    if not isinstance(step_s, float) or len(digits) < 5 or step <= 0:
        return step
    for frames in (Fraction(1), Fraction(1000, 1001)):
        rate = round(1 / step / frames)
        near = 1 / (rate * frames) if rate else step
        if abs(near - step) <= step / 10 ** (len(digits) - 1):
            return near
    return step


@lru_cache(maxsize=1 << 14)
def _decimal(value: float) -> Fraction:
    # A subclass, such as numpy's, may have its own idea of repr.
    return Fraction(float.__repr__(value))


def floor_of(threshold: Threshold) -> float:
    """Smallest float whose decimal passes a threshold; infinity if none does.

    Decimals of floats are in the order of the floats, so these and no others are at least it.
    """
    try:
        result = float(threshold.limit)
    except OverflowError:
        return inf if threshold.limit > 0 else -inf
    # The nearest float. The decimals of the others are nearest to those, so they are beyond the
    # limit on their side of it; that of this one may be on either.
    number = _decimal(result)
    passes = number >= threshold.limit if threshold.inclusive else number > threshold.limit
    return result if passes else nextafter(result, inf)


@lru_cache(maxsize=1 << 12)
def bound_in_floats(
    proposition: Proposition,
) -> tuple[QuantityTerm, Callable[[float], bool]] | None:
    """The quantity that a comparison is about, and what floats stand in its relation; else None.

    It is exact: floats stand for their decimals, as in ``floor_of``.
    """
    match proposition:
        case Comparison(((1, QuantityTerm() as term),), relation, limit):
            if relation in ("=", "!="):
                return None
            floor = floor_of(Threshold(limit, relation in (">=", "<")))
            return term, floor.__le__ if relation in (">=", ">") else floor.__gt__
    return None


@dataclass(frozen=True, slots=True, eq=False)
class ThresholdScale:
    """A number that a rule reads, made ready for many states.

    ``variables`` and ``names`` are those that it depends on. ``quantity`` is the quantity that it
    is, None if it is a count or a sum. ``floors`` are ``floor_of`` each of the thresholds.
    """

    read: NumberRead
    variables: tuple[str, ...]
    names: tuple[str, ...]
    quantity: QuantityTerm | None
    floors: tuple[float, ...]

    def digit(self, value: Value) -> int:
        """The digit of the quantity's value."""
        assert not isinstance(value, str), "check_state has refused it"
        if type(value) is WrittenNumber:
            return self.read.digit(value.exact)
        if isinstance(value, float) or -EXACT_IN_FLOATS <= value <= EXACT_IN_FLOATS:
            return bisect_right(self.floors, value)
        return self.read.digit(Fraction(value))


@lru_cache(maxsize=1 << 12)
def scale(read: NumberRead) -> ThresholdScale:
    """The threshold scale of a read."""
    variables = dict.fromkeys(name for _, term in read.terms for name in variables_of(term))
    names = dict.fromkeys(name for _, term in read.terms for name in names_in(term))
    quantity = None
    match read.terms:
        case ((1, QuantityTerm() as term),):
            quantity = term
    floors = tuple(map(floor_of, read.thresholds))
    return ThresholdScale(read, tuple(variables), tuple(names), quantity, floors)
