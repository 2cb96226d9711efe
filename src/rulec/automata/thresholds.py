"""Numbers as exact decimals, and the thresholds that they pass."""

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
"""Whole numbers up to this size are exact as floats, and equal their own decimals."""


_MOST_FRAMES = 1000
"""The most frames per second of a rate whose step a float may stand for."""


def exact(value: Fraction | float) -> Fraction:
    """The exact value of a number as written: 0.1 is one tenth, not the float nearest to it."""
    if type(value) is WrittenNumber:
        return value.exact
    return _decimal(value) if isinstance(value, float) else Fraction(value)


@lru_cache(maxsize=1 << 8)
def exact_step(step_s: Fraction | float) -> Fraction:
    """The exact step (s) that a number stands for: as written.

    Steps of frame rates often have no finite decimal. The float that is nearest to the step of 1 to
    1000 frames per second, or a thousand of those in 1001 s as in video, stands for that step.
    """
    step = exact(step_s)
    if not isinstance(step_s, float) or step <= 0:
        return step
    for frames in (Fraction(1), Fraction(1000, 1001)):
        rate = round(1 / step / frames)
        if 1 <= rate <= _MOST_FRAMES and float(1 / (rate * frames)) == float(step):
            return 1 / (rate * frames)
    return step


@lru_cache(maxsize=1 << 14)
def _decimal(value: float) -> Fraction:
    # A subclass, such as NumPy's, may have a different repr.
    return Fraction(float.__repr__(value))


def floor_of(threshold: Threshold) -> float:
    """The smallest float whose decimal passes a threshold; infinity if none does.

    Decimals of floats are ordered as the floats are, so exactly the floats from this one on pass.
    """
    try:
        result = float(threshold.limit)
    except OverflowError:
        return inf if threshold.limit > 0 else -inf
    # This float is nearest to the limit. Every other float's decimal is nearest to that float, so
    # it lies on that float's side of the limit; this one's decimal may lie on either side.
    number = _decimal(result)
    passes = number >= threshold.limit if threshold.inclusive else number > threshold.limit
    return result if passes else nextafter(result, inf)


@lru_cache(maxsize=1 << 12)
def bound_in_floats(
    proposition: Proposition,
) -> tuple[QuantityTerm, Callable[[float], bool]] | None:
    """The quantity in a comparison and a test of its floats; None if it has no such form.

    The test is exact: floats stand for their decimals, as in ``floor_of``.
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
    """A number that a rule reads, prepared for evaluation in many states.

    ``variables`` and ``names`` are those that it depends on. ``quantity`` is set if the number is a
    single quantity, None for a count or a sum. ``floors`` are the ``floor_of`` all thresholds.
    """

    read: NumberRead
    variables: tuple[str, ...]
    names: tuple[str, ...]
    quantity: QuantityTerm | None
    floors: tuple[float, ...]

    def digit(self, value: Value) -> int:
        """The digit of a value of the quantity."""
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
