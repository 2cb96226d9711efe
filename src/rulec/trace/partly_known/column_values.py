"""The values of names in columns, as values that are partly known."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags
from rulec.trace.partly_known.partly_known_values import (
    EnumeratedChoice,
    NameValues,
    Number,
    Truth,
)
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Declaration, Enumeration, Quantity


def partly_known(
    declaration: Declaration | None, values: Array, upper: Array, unknown: Flags | None
) -> NameValues:
    """The values of a name: Booleans, numbers up to ``upper``, or places among those declared.

    Where they are ``unknown`` their entries are meaningless.
    """
    if unknown is not None and not unknown.any():
        unknown = None
    if isinstance(declaration, Enumeration):
        n_values = len(declaration.values)
        kind = np.min_scalar_type(1 << n_values)
        bits = np.array([1 << place for place in range(n_values)], dtype=kind)
        if unknown is None:
            return EnumeratedChoice(bits[values])
        return EnumeratedChoice(np.where(unknown, bits.sum(dtype=kind), bits[values]))
    if isinstance(declaration, Quantity):
        if unknown is None:
            return Number(values, upper)
        return Number(np.where(unknown, -np.inf, values), np.where(unknown, np.inf, upper))
    truth = Truth.known(values)
    return truth if unknown is None else truth.unknown_at(unknown)
