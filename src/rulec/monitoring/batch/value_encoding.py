"""Values as the numbers that columns hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rulec.trace.trace_columns import Array, smallest_unsigned
from rulec.vocabulary import Declaration, Enumeration, Signal

_EXACT_IN_FLOATS = 1 << 53


class OddError(Exception):
    """Some state does not fit the vocabulary, or leaves out what has no default."""


def type_of(declaration: Declaration) -> np.dtype[Any]:
    """What the column of a name holds: see ``TraceColumns``."""
    if isinstance(declaration, Enumeration):
        return smallest_unsigned(len(declaration.values))
    return np.dtype(bool if isinstance(declaration, Signal) else np.float64)


def meant(values: Sequence[Any], declaration: Declaration) -> Array:
    """What values mean; OddError if one does not fit, and for some of unusual types."""
    kinds = set(map(type, values))
    if isinstance(declaration, Enumeration):
        places = {value: place for place, value in enumerate(declaration.values)}
        if kinds != {str} or not places.keys() >= set(values):
            raise OddError
        return np.fromiter(map(places.__getitem__, values), type_of(declaration), len(values))
    if isinstance(declaration, Signal):
        if kinds != {bool}:
            raise OddError
        return np.array(values, dtype=bool)
    if not kinds <= {int, float}:
        raise OddError
    whole = [value for value in values if type(value) is int] if int in kinds else []
    if any(abs(value) > _EXACT_IN_FLOATS for value in whole):
        raise OddError
    numbers = np.array(values, dtype=np.float64)
    if not np.isfinite(numbers).all():
        raise OddError
    return numbers
