"""Blocks of a table: whole traces as columns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats.table_reader import STEP_S, Row, Table, traces_in
from rulec.trace.trace_model import Trace


class OddTableError(Exception):
    """Table that has to be read row by row, or refused."""


@dataclass(frozen=True, slots=True, eq=False)
class Coded:
    """A column in which few values are met again and again.

    ``codes`` (signed integers) are for each row a place in ``values``, or -1 for an empty cell.
    Those that tell things apart are distinct.
    """

    codes: NDArray[Any]
    values: Sequence[Any]

    @property
    def given(self) -> NDArray[np.bool_]:
        """The rows whose cell is not empty."""
        return self.codes >= 0


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """Column of ``float64``; cells that are not ``given`` are arbitrary."""

    numbers: NDArray[np.float64]
    given: NDArray[np.bool_]


Column = Coded | Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Block(Sequence["Trace | RulecError"]):
    """Traces whose rows stand together, first read when they are asked for.

    ``columns`` has what is in the ``table``'s columns. ``starts`` are the rows with which traces
    begin, counted from 0, and how many rows there are. ``rows`` gives those from one to another
    (exclusive) as ``traces_in`` reads them.
    """

    table: Table
    columns: Mapping[str, Column]
    starts: NDArray[np.int64]
    rows: Callable[[int, int], Iterable[Row]]
    file: SourceLocation

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, place: int) -> Trace | RulecError: ...
    @overload
    def __getitem__(self, place: slice) -> list[Trace | RulecError]: ...
    def __getitem__(self, place: int | slice) -> Trace | RulecError | list[Trace | RulecError]:
        if isinstance(place, slice):
            return [self[index] for index in range(len(self))[place]]
        place = range(len(self))[place]
        (trace,) = self._read(int(self.starts[place]), int(self.starts[place + 1]))
        return trace

    def __iter__(self) -> Iterator[Trace | RulecError]:
        return self._read(0, int(self.starts[-1]))

    def step_s(self, place: int) -> float:
        """Step of a trace (s), if nothing about it is odd."""
        column, row = self.columns.get(STEP_S), self.starts[place]
        if column is None or not column.given[row]:
            return 1.0
        result = column.numbers if isinstance(column, Numbers) else column.values
        return float(result[row if isinstance(column, Numbers) else column.codes[row]])

    def _read(self, start: int, stop: int) -> Iterator[Trace | RulecError]:
        return traces_in(self.rows(start, stop), self.table, self.file)


def trace_starts(traces: Coded) -> NDArray[np.int64]:
    """The rows with which traces begin, by the column that names them."""
    codes = traces.codes
    changes = np.flatnonzero(codes[1:] != codes[:-1]) + 1
    return np.concatenate([np.zeros(min(len(codes), 1), np.int64), changes])
