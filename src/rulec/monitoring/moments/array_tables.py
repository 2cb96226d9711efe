"""Name tables of traces in arrays, with a row for each object."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.moments.name_tables import NameTables, default_of, partly_known
from rulec.trace.partly_known.partly_known_values import NameValues, Number
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Enumeration, Vocabulary


class ArrayTables(NameTables):
    """Tables of a trace that is given as arrays, which have no names about several objects."""

    def __init__(self, arrays: TraceArrays, vocabulary: Vocabulary) -> None:
        last = np.array([arrays.n_states - 1], dtype=np.intp)
        super().__init__(arrays.told, arrays.objects, last, vocabulary)
        self._arrays = arrays
        state = np.arange(arrays.n_states)
        first, last = arrays.spans[:, :1], arrays.spans[:, 1:]
        self._there: Flags = (state >= first) & (state <= last)

    @property
    def spans(self) -> Indices:
        """The first and last state of each object."""
        return self._arrays.spans

    def about_several(self, name: str, rows: Indices) -> NameValues:
        """The rows of a name, which all have its default."""
        return self._rows(name, None, np.ones((len(rows), self.n_states), dtype=bool))

    def _world(self, name: str) -> NameValues:
        column = self._arrays.world.get(name)
        return self._rows(name, column, np.ones((1, self.n_states), dtype=bool))

    def _about(self, name: str) -> NameValues:
        return self._rows(name, self._arrays.about.get(name), self._there)

    def _rows(self, name: str, column: Array | None, there: Flags) -> NameValues:
        """Rows of values in the states that are ``there``.

        Names that are never given have their default.
        """
        declaration = self.vocabulary.declarations[name]
        default, is_known = default_of(declaration)
        values: Array = np.full(there.shape, default, dtype=type(default))
        unknown: Flags = np.full(there.shape, not is_known)
        upper = values
        if column is not None:
            arrays = self._arrays
            given = arrays.is_given(name)
            if isinstance(declaration, Enumeration):
                places = [declaration.values.index(text) for text in arrays.texts[name]]
                column = np.asarray(places)[column]
            values[there] = np.where(given, column, default)
            unknown[there] = np.where(given, arrays.unknown.get(name, np.False_), not is_known)
            if name in arrays.bounds:
                upper = values.copy()
                low, high = arrays.bounds[name]
                values[there] = np.where(given, low, default)
                upper[there] = np.where(given, high, default)
        rows = partly_known(declaration, values, upper, unknown)
        return _constant(rows, there) if declaration.constant else rows


def _constant(rows: NameValues, there: Flags) -> NameValues:
    """Rows of a constant, whose value in some state holds in all."""
    is_stated = there & ~rows.unknown
    any_stated = is_stated.any(axis=1, keepdims=True)
    if isinstance(rows, Number) and (is_stated & (rows.low != rows.high)).any():
        # The intersection of several intervals.
        low = np.where(is_stated, rows.low, -np.inf).max(axis=1, keepdims=True)
        high = np.where(is_stated, rows.high, np.inf).min(axis=1, keepdims=True)
        return Number(np.where(any_stated, low, rows.low), np.where(any_stated, high, rows.high))
    first = is_stated.argmax(axis=1)[:, None]
    return rows.each(lambda half: np.where(any_stated, np.take_along_axis(half, first, 1), half))
