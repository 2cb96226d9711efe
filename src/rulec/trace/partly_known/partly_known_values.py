"""Values that are partly known, in many states at once: truth, numbers and choices.

Halves of truth are NumPy masks or, where there is no NumPy, integers with a bit per state, in which
bits beyond the last state mean nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic

if TYPE_CHECKING:
    from typing_extensions import TypeVar

    from rulec.array_types import Flags

    Half = TypeVar("Half", int, Flags, default=Flags)
else:
    from typing import TypeVar

    Half = TypeVar("Half")


@dataclass(frozen=True, slots=True, eq=False)
class Truth(Generic[Half]):
    """Where something is ``sure`` and where it is ``possible``; masks have shapes that broadcast.

    What is sure is also possible. The operators are those of Kleene's strong three-valued logic;
    the other operand may be a mask, which is known.
    """

    sure: Half
    possible: Half
    # So that a mask on the left leaves the operation to this class
    __array_ufunc__: ClassVar[None] = None

    @staticmethod
    def known(values: Half) -> Truth[Half]:
        """Truth that is known everywhere."""
        return Truth(values, values)

    @property
    def is_known(self) -> bool:
        """Whether it is known everywhere by its making: both halves are one object."""
        return self.sure is self.possible

    def __invert__(self) -> Truth[Half]:
        return Truth.known(~self.sure) if self.is_known else Truth(~self.possible, ~self.sure)

    def __and__(self, other: Truth[Half] | Half) -> Truth[Half]:
        given = other if isinstance(other, Truth) else Truth.known(other)
        if self.is_known and given.is_known:
            return Truth.known(self.sure & given.sure)
        return Truth(self.sure & given.sure, self.possible & given.possible)

    __rand__ = __and__

    def __or__(self, other: Truth[Half] | Half) -> Truth[Half]:
        given = other if isinstance(other, Truth) else Truth.known(other)
        if self.is_known and given.is_known:
            return Truth.known(self.sure | given.sure)
        return Truth(self.sure | given.sure, self.possible | given.possible)

    __ror__ = __or__

    def same_as(self, other: Truth[Half]) -> Truth[Half]:
        """Both or neither."""
        return self & other | ~self & ~other

    def or_possibly(self, possible: Half) -> Truth[Half]:
        """The same truth, but possible where ``possible``, too."""
        return Truth(self.sure, self.possible | possible)

    def unknown_at(self, unknown: Half) -> Truth[Half]:
        """The same truth, but unknown where ``unknown``."""
        return Truth(self.sure & ~unknown, self.possible | unknown)

    @property
    def unknown(self) -> Half:
        """Where it is possible, but not sure."""
        return self.possible & ~self.sure

    def each(self, change: Callable[[Half], Half]) -> Truth[Half]:
        """The truth with both halves changed."""
        if self.is_known:
            return Truth.known(change(self.sure))
        return Truth(change(self.sure), change(self.possible))


@dataclass(frozen=True, slots=True, eq=False)
class Number:
    """Numbers that lie between ``low`` and ``high``, both included; unknown ones have no bounds.

    Each end is one number or an array of them.
    """

    low: Any
    high: Any

    @staticmethod
    def within(values: Any, error: Any) -> Number:
        """Numbers that were measured with an error, which may be as large as this."""
        return Number(values - error, values + error)

    def __gt__(self, other: Any) -> Truth:
        """Whether they are above a known number, or known numbers."""
        return Truth(self.low > other, self.high > other)

    def __lt__(self, other: Any) -> Truth:
        """Whether they are below a known number, or known numbers."""
        return Truth(self.high < other, self.low < other)

    @property
    def unknown(self) -> Any:
        """Where nothing is known of the number."""
        return self.high - self.low == float("inf")

    def __add__(self, other: Number) -> Number:
        low = self.low + other.low
        is_known = self.high is self.low and other.high is other.low
        return Number(low, low if is_known else self.high + other.high)

    def each(self, change: Callable[[Any], Any]) -> Number:
        """The numbers with both ends changed."""
        low = change(self.low)
        return Number(low, low if self.high is self.low else change(self.high))


@dataclass(frozen=True, slots=True, eq=False)
class EnumeratedChoice:
    """Values of an enumeration, as ``bits``: value ``i`` is possible where bit ``i`` is set."""

    bits: Any

    @property
    def unknown(self) -> Any:
        """Where several values are possible."""
        return self.bits & (self.bits - 1) != 0

    def equals(self, place: int) -> Truth:
        """Whether it is a value."""
        bit = 1 << place
        return Truth(self.bits == bit, self.bits & bit != 0)

    def each(self, change: Callable[[Any], Any]) -> EnumeratedChoice:
        """The values with changed bits."""
        return EnumeratedChoice(change(self.bits))


NameValues = Truth | Number | EnumeratedChoice
"""A name's values: of a signal, a quantity, an enumeration."""
