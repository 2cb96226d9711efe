"""Values that are unknown or known only within bounds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final, Literal

from rulec.diagnostics.argument_kinds import expected


class UnknownValue(Enum):
    """The type of ``UNKNOWN``."""

    UNKNOWN = "?"

    def __repr__(self) -> str:
        return "UNKNOWN"

    # UNKNOWN is in many dictionary keys, and Enum hashes a member's name again on every call.
    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        raise TypeError("what is unknown is neither true nor false")


UNKNOWN: Final = UnknownValue.UNKNOWN
"""A value that the source does not provide: any that its declaration and the other values allow."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A number known to lie between two bounds, inclusive.

    Raises ValueError if the bounds are not finite or not in order.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        # Fast path: large graphs have tens of thousands of intervals
        if type(self.low) is not float or type(self.high) is not float:
            expected("low", "float", self.low)
            expected("high", "float", self.high)
        if not float("-inf") < self.low <= self.high < float("inf"):
            raise ValueError("an interval has finite bounds, the lower one first")

    @property
    def middle(self) -> float:
        """The midpoint of the bounds, rounded to nine decimals if that stays within them."""
        middle = (self.low + self.high) / 2
        short = round(middle, 9)
        return short if self.low <= short <= self.high else middle

    @property
    def error(self) -> float:
        """The largest possible error of ``middle``: half the width."""
        return (self.high - self.low) / 2


@dataclass(frozen=True, slots=True)
class OneOf:
    """An enumeration's value, known only to be one of ``values``, as in a cell of a graph."""

    values: frozenset[str]


UNKNOWN_TYPES = frozenset({UnknownValue, Interval, OneOf})

Unknown = Literal[UnknownValue.UNKNOWN]
PartialValue = bool | float | str | Unknown | Interval | OneOf
"""What a state can give for a name: a value, a range or set that contains it, or UNKNOWN."""
