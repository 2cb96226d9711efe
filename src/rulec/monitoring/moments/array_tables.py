"""Name tables of traces in arrays, with a row for each object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.monitoring.moments.name_tables import NameTables, ValueRows, default_of
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
    def spans(self) -> NDArray[np.intp]:
        """The first and last state of each object."""
        return self._arrays.spans

    def about_several(self, name: str, rows: NDArray[np.intp]) -> ValueRows:
        """The rows of a name, which all have its default."""
        return self._rows(name, None, np.ones((len(rows), self.n_states), dtype=bool))

    def _world(self, name: str) -> ValueRows:
        column = self._arrays.world.get(name)
        return self._rows(name, column, np.ones((1, self.n_states), dtype=bool))

    def _about(self, name: str) -> ValueRows:
        rows = self._rows(name, self._arrays.about.get(name), self._there)
        only = self._arrays.only.get(name)
        if only is None or name not in self._arrays.about or only.all():
            return rows
        others = self._rows(name, None, self._there)
        chosen = np.asarray(only)[:, None]
        return ValueRows(
            np.where(chosen, rows.values, others.values),
            np.where(chosen, rows.upper, others.upper),
            np.where(chosen, rows.unknown, others.unknown),
        )

    def _rows(self, name: str, column: Array | None, there: Flags) -> ValueRows:
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
            given: Flags = ~arrays.absent[name] if name in arrays.absent else np.True_  # type: ignore[assignment]
            if isinstance(declaration, Enumeration):
                places = [declaration.values.index(text) for text in arrays.texts[name]]
                column = np.asarray(places)[column]
            dark = arrays.unknown.get(name, np.False_)
            values[there] = np.where(given, column, default)
            unknown[there] = np.where(given, dark, not is_known)
            if name in arrays.bounds:
                upper = values.copy()
                low, high = arrays.bounds[name]
                values[there] = np.where(given, low, default)
                upper[there] = np.where(given, high, default)
        rows = ValueRows(values, upper, unknown)
        return _constant(rows, there) if declaration.constant else rows


def _constant(rows: ValueRows, there: Flags) -> ValueRows:
    """Rows of a constant, whose value in some state holds in all."""
    is_stated = there & ~rows.unknown
    any_stated = is_stated.any(axis=1, keepdims=True)
    first = is_stated.argmax(axis=1)[:, None]
    values = np.where(any_stated, np.take_along_axis(rows.values, first, 1), rows.values)
    if rows.upper is rows.values:
        return ValueRows(values, values, rows.unknown & ~any_stated)
    # The intersection of several intervals.
    low = np.where(is_stated, rows.values, -np.inf).max(axis=1, keepdims=True)
    high = np.where(is_stated, rows.upper, np.inf).min(axis=1, keepdims=True)
    low, high = np.broadcast_arrays(low, values)[0], np.broadcast_arrays(high, values)[0]
    return ValueRows(
        np.where(any_stated, low, rows.values),
        np.where(any_stated, high, rows.upper),
        rows.unknown & ~any_stated,
    )
