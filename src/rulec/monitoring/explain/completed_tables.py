"""Tables of a trace in which every unknown value is replaced by a supposed one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.moments.name_tables import NameTables, ValueRows, default_of
from rulec.monitoring.uncertainty.one_completion import Supposed, number_at
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Enumeration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import Interval


class CompletedTables(NameTables):
    """The tables of one trace, completed as ``one_completion.completed`` completes its states.

    Names that ``declared`` gives no default have their least value, unless one is supposed.
    """

    def __init__(self, tables: NameTables, declared: Vocabulary, supposed: Supposed) -> None:
        objects = dict(zip(tables.objects, tables.types, strict=True))
        super().__init__(None, objects, tables.last, declared)
        self._tables, self._supposed = tables, supposed

    @property
    def spans(self) -> NDArray[np.intp]:
        """The first and last state of each object."""
        return self._tables.spans

    def about_several(self, name: str, rows: NDArray[np.intp]) -> ValueRows:
        """The rows of a name for these objects (rows x parameters), given by their numbers."""
        return self._completed(name, self._tables.about_several(name, rows))

    def _world(self, name: str) -> ValueRows:
        return self._completed(name, self._tables.world(name))

    def _about(self, name: str) -> ValueRows:
        return self._completed(name, self._tables.about(name))

    def _completed(self, name: str, rows: ValueRows) -> ValueRows:
        declaration = self.vocabulary.declarations[name]
        values: Array = rows.values
        if isinstance(declaration, Quantity) and rows.upper is not values:
            end = self._supposed.ends.get(name)
            between = np.vectorize(lambda low, high: number_at(Interval(low, high), end), "d")
            apart = (values != rows.upper) & ~rows.unknown
            values = np.array(values, dtype=float)
            values[apart] = between(values[apart], rows.upper[apart]) if apart.any() else 0
        value = self._supposed.values.get(name)
        if value is None:
            value, _ = default_of(declaration)
        elif isinstance(declaration, Enumeration):
            value = declaration.values.index(str(value))
        known = np.where(rows.unknown, value, values)
        return ValueRows(known, known, np.zeros_like(rows.unknown))
