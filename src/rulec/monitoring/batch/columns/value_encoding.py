"""Encoding of values as the numbers that columns hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.state_validation import NUMBERS, TRUTHS
from rulec.trace.trace_columns import Array, smallest_unsigned
from rulec.vocabulary import Declaration, Enumeration, Signal


class UnencodableError(Exception):
    """State with an invalid, missing or unusual value."""


def column_dtype(declaration: Declaration) -> np.dtype[Any]:
    """The numbers that the column of a name holds: see ``TraceColumns``."""
    if isinstance(declaration, Enumeration):
        return smallest_unsigned(len(declaration.values))
    return np.dtype(bool if isinstance(declaration, Signal) else np.float64)


def encode_values(values: Sequence[Any], declaration: Declaration) -> Array:
    """Encode values. Raises UnencodableError for invalid values and unusual types."""
    kinds = set(map(type, values))
    if isinstance(declaration, Enumeration):
        places = {value: place for place, value in enumerate(declaration.values)}
        if kinds != {str} or not places.keys() >= set(values):
            raise UnencodableError
        return np.fromiter(map(places.__getitem__, values), column_dtype(declaration), len(values))
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
