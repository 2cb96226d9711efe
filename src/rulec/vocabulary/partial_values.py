"""Values that are not, or not exactly, known."""

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

    # It is part of many keys, and an enumeration hashes its members' names anew each time.
    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        raise TypeError("what is unknown is neither true nor false")


UNKNOWN: Final = UnknownValue.UNKNOWN
"""A value that the source cannot tell: any that its declaration and what else is known allow."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A number known to lie between two others, bounds included.

    Raises ValueError if the bounds are not finite and in order.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        # Graphs of many cells have ten thousands of them
        if type(self.low) is not float or type(self.high) is not float:
            expected("low", "float", self.low)
            expected("high", "float", self.high)
        if not float("-inf") < self.low <= self.high < float("inf"):
            raise ValueError("an interval has finite bounds, the lower one first")

    @property
    def middle(self) -> float:
        """The number half-way between the bounds, with no more decimals than it takes."""
        middle = (self.low + self.high) / 2
        short = round(middle, 9)
        return short if self.low <= short <= self.high else middle

    @property
    def error(self) -> float:
        """How far the middle may be wrong."""
        return (self.high - self.low) / 2


@dataclass(frozen=True, slots=True)
class OneOf:
    """A value of an enumeration known to be one of several, as in a cell of a graph."""

    values: frozenset[str]


UNKNOWN_TYPES = frozenset({UnknownValue, Interval, OneOf})

Unknown = Literal[UnknownValue.UNKNOWN]
PartialValue = bool | float | str | Unknown | Interval | OneOf
"""What a state may say of a name: a value, what it is among or between, or that it is unknown."""
