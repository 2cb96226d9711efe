"""Encoded values of names, unless one is irregular."""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import Any, NamedTuple

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.state_validation import NUMBERS, TRUTHS
from rulec.trace.trace_columns import Array, smallest_unsigned
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue, UnknownValue
from rulec.vocabulary.vocabulary_model import least_value, values_of


class UnencodableError(Exception):
    """A state has an invalid, missing or unusual value."""


def column_dtype(declaration: Declaration) -> np.dtype[Any]:
    """The data type of a name's column: see ``TraceColumns``."""
    if isinstance(declaration, Enumeration):
        return smallest_unsigned(len(declaration.values))
    return np.dtype(bool if isinstance(declaration, Signal) else np.float64)


def either(first: Flags | None, second: Flags | None) -> Flags | None:
    """Where at least one of two flags is set; None means nowhere."""
    if first is None or second is None:
        return second if first is None else first
    return first | second


class PartlyKnown(NamedTuple):
    """A column of values, or of the least ones where ``upper`` has the greatest.

    They mean nothing where they are ``unknown``, or ``missing``: not given, without a default. None
    means nowhere.
    """

    values: Array
    upper: Array | None = None
    unknown: Flags | None = None
    missing: Flags | None = None

    @property
    def apart(self) -> Flags | None:
        """Where a number is known only as an interval."""
        return None if self.upper is None else self.upper != self.values

    @property
    def partial(self) -> Flags | None:
        """Where no single value is known."""
        return either(self.apart, self.unknown)

    def at(self, places: Indices | Flags) -> PartlyKnown:
        """The column of some of the places."""
        upper, unknown, missing = (None if x is None else x[places] for x in self[1:])
        return PartlyKnown(self.values[places], upper, unknown, missing)

    def decoded(self, declaration: Declaration) -> list[PartialValue | None]:
        """The values as states give them."""
        cells: list[Any] = self.values.tolist()
        if isinstance(declaration, Enumeration):
            cells = [declaration.values[place] for place in cells]
        elif isinstance(declaration, Quantity) and self.upper is not None:
            ends = zip(cells, self.upper.tolist(), strict=True)
            cells = [low if low == high else Interval(low, high) for low, high in ends]
        if self.unknown is not None:
            for place in self.unknown.nonzero()[0].tolist():
                cells[place] = UNKNOWN
        return cells


def encode_partly_known(values: Sequence[Any], declaration: Declaration) -> PartlyKnown:
    """Encode values, of which some may be unknown or intervals. Raises UnencodableError."""
    kinds = set(map(type, values))
    unknown = None
    if UnknownValue in kinds:
        if Interval not in kinds:
            column, unknown = _with_unknown(values, kinds, declaration)
            return PartlyKnown(column, unknown=unknown)
        unknown = np.array([value is UNKNOWN for value in values])
        anything = least_value(declaration)
        values = [anything if value is UNKNOWN else value for value in values]
    if Interval in kinds:
        ends = [value.low if type(value) is Interval else value for value in values]
        ends += [value.high if type(value) is Interval else value for value in values]
        both = encode_values(ends, declaration)
        return PartlyKnown(both[: len(values)], both[len(values) :], unknown)
    return PartlyKnown(encode_values(values, declaration), unknown=unknown)


def _with_unknown(
    values: Sequence[Any], kinds: Set[type], declaration: Declaration
) -> tuple[Array, Flags]:
    """Encoded values, and the mask of unknown ones. Raises UnencodableError."""
    if isinstance(declaration, Quantity):
        unknown = np.array([value is UNKNOWN for value in values])
        known = [0.0 if value is UNKNOWN else value for value in values]
        return encode_values(known, declaration), unknown
    own = values_of(declaration)
    if not kinds <= {type(own[0]), UnknownValue}:
        raise UnencodableError
    numbers = _places((*own, UNKNOWN), values)
    unknown = numbers == len(own)
    numbers[unknown] = 0
    return numbers.astype(column_dtype(declaration)), unknown


def _places(among: tuple[Any, ...], values: Sequence[Any]) -> Array:
    """The places of values among others. Raises UnencodableError."""
    places = {value: place for place, value in enumerate(among)}
    try:
        return np.fromiter(
            map(places.__getitem__, values), smallest_unsigned(len(among)), len(values)
        )
    except KeyError:
        raise UnencodableError from None


def encode_values(values: Sequence[Any], declaration: Declaration) -> Array:
    """Encode values. Raises UnencodableError for invalid values and unusual types."""
    kinds = set(map(type, values))
    if isinstance(declaration, Enumeration):
        if kinds != {str}:
            raise UnencodableError
        return _places(declaration.values, values)
    if isinstance(declaration, Signal):
        if kinds != TRUTHS:
            raise UnencodableError
        return np.array(values, dtype=bool)
    if not kinds <= NUMBERS:
        raise UnencodableError
    whole = [value for value in values if type(value) is int] if int in kinds else []
    if any(abs(value) > EXACT_IN_FLOATS for value in whole):
        raise UnencodableError
    numbers = np.array(values, dtype=np.float64)
    if not np.isfinite(numbers).all():
        raise UnencodableError
    return numbers
