"""The possible digits of reads, by encoded values that may be unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.monitoring.online.encoding.encoded_values import MISSING, UNKNOWN_DIGIT, DigitWeight
from rulec.monitoring.uncertainty.state_letters.read_digits import possible_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.vocabulary.partial_values import UNKNOWN

MOST_KNOWN = 1 << 12
"""How many values of a part are kept before all are discarded."""

_VALUES: Mapping[object, Any] = {MISSING: None, UNKNOWN_DIGIT: UNKNOWN}
"""The values that stand for missing and unknown ones."""


class PartNumbers(dict[tuple[Any, ...], int]):
    """The numbers of a part of entangled reads, by its encoded values.

    Raises LookupError if a value is missing or not ``allowed``.
    """

    def __init__(
        self,
        number: Callable[[tuple[Any, ...]], int],
        allowed: Sequence[frozenset[object] | None],
    ) -> None:
        self._number, self._allowed = number, allowed

    def __missing__(self, encoded: tuple[Any, ...]) -> int:
        for allowed, value in zip(self._allowed, encoded, strict=True):
            if allowed is not None and value not in allowed:
                raise LookupError
        if len(self) >= MOST_KNOWN:
            self.clear()
        try:
            number = self._number(tuple([_VALUES.get(x, x) for x in encoded]))
        except MissingValueError:
            raise LookupError from None
        self[encoded] = number
        return number


def digit_bits(read: Read | NumberRead, digit: Any, weight_of: DigitWeight) -> int:
    """The possible digits, as bits, of a read with a digit or a range of digits.

    Raises LookupError if that is invalid.
    """
    if digit is UNKNOWN_DIGIT:
        return possible_digits(read, UNKNOWN)
    weight_of(digit)
    if isinstance(read, NumberRead):
        return sum([1 << own for own in digit]) if type(digit) is range else 1 << digit
    return possible_digits(read, digit)
