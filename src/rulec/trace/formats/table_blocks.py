"""Blocks of a table: whole traces as columns, and when their objects are present."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, get_args, overload

import numpy as np
from numpy.typing import NDArray

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats import table_reader as tables
from rulec.trace.formats.table_reader import ENDS, OBJECT, OTHER, STEP, STEP_S, TRACE, TYPE
from rulec.trace.trace_model import Ending, Trace, ending_in_file
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue


class OddTableError(Exception):
    """The table has to be read row by row, or refused."""


@dataclass(frozen=True, slots=True, eq=False)
class Coded:
    """A column with few distinct values.

    ``codes`` (signed integers) give each row's index in ``values``, or -1 for an empty cell. In
    columns that identify something, values are distinct.
    """

    codes: NDArray[Any]
    values: Sequence[Any]

    @property
    def given(self) -> NDArray[np.bool_]:
        """Mask of the rows whose cell is not empty."""
        return self.codes >= 0

    def given_at(self, rows: slice) -> NDArray[np.bool_]:
        """Mask of those of some rows whose cell is not empty, without looking at the others."""
        result: NDArray[np.bool_] = self.codes[rows] >= 0
        return result


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """A column of ``float64``; cells that are not ``given`` are arbitrary.

    ``whole``: the table has integers.
    """

    numbers: NDArray[np.float64]
    given: NDArray[np.bool_]
    whole: bool = False

    def given_at(self, rows: slice) -> NDArray[np.bool_]:
        """Mask of those of some rows whose cell is not empty."""
        return self.given[rows]


Column = Coded | Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Block(Sequence["Trace | RulecError"]):
    """Traces in consecutive rows, each read only when asked for.

    ``columns`` holds the ``table``'s columns. ``starts`` are the rows, from 0, where traces begin,
    then the number of rows. ``rows`` gives those from one row to another (exclusive) as
    ``traces_in`` reads them. ``partial`` are the traces with something unknown or a number that no
    float represents; ``unsaid`` are those of them for which the columns do not show it. ``unknown``
    are the rows in which a name's value is unknown. With an ``outline`` nothing else is irregular,
    and traces are made from it and the columns.
    """

    table: tables.Table
    columns: Mapping[str, Column]
    starts: NDArray[np.int64]
    rows: Callable[[int, int], Iterable[tables.Row]]
    file: SourceLocation
    partial: frozenset[int] = frozenset()
    unsaid: frozenset[int] = frozenset()
    unknown: Mapping[str, NDArray[np.int64]] = field(default_factory=dict)
    outline: BlockPresence | None = None

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
        if self.outline is not None and place not in self.unsaid:
            outlined_trace = _outlined_trace(self, self.outline, place)
            if outlined_trace is not None:
                return outlined_trace
        (trace,) = self._read(int(self.starts[place]), int(self.starts[place + 1]))
        return trace

    def __iter__(self) -> Iterator[Trace | RulecError]:
        return self._read(0, int(self.starts[-1]))

    def step_s(self, place: int) -> float:
        """The step of a trace in seconds, if nothing about it is irregular."""
        column, row = self.columns.get(STEP_S), int(self.starts[place])
        if column is None or not column.given_at(slice(row, row + 1)).all():
            return 1.0
        result = column.numbers if isinstance(column, Numbers) else column.values
        return float(result[row if isinstance(column, Numbers) else column.codes[row]])

    def _read(self, start: int, stop: int) -> Iterator[Trace | RulecError]:
        return tables.traces_in(self.rows(start, stop), self.table, self.file)


def trace_starts(traces: Coded) -> NDArray[np.int64]:
    """The rows where traces begin, from the column of trace names."""
    codes = traces.codes
    changes = np.flatnonzero(codes[1:] != codes[:-1]) + 1
    return np.concatenate([np.zeros(min(len(codes), 1), np.int64), changes])


Rows = NDArray[np.int64]
"""An integer for each row."""

NOBODY = -1


@dataclass(frozen=True, slots=True, eq=False)
class BlockPresence:
    """The objects of each trace, and those that each row is about.

    Each row has its ``trace``, its ``step``, and the objects it is about: ``item`` and ``other``
    are indices among its trace's objects, in the order of their first rows, or NOBODY.

    Each trace has ``names``, a ``length`` in states, a step in seconds, an end, and from ``starts``
    on its objects: their names (``objects``), their ``types``, and in ``stretches`` the first and
    last state in which each is present, or twice NOBODY if it always is.
    """

    trace: Rows
    step: Rows
    item: Rows
    other: Rows
    names: list[str]
    length: NDArray[np.int64]
    step_s: NDArray[np.float64]
    ends: Sequence[Ending]
    starts: NDArray[np.int64]
    objects: list[str]
    types: list[str]
    stretches: NDArray[np.int64]

    def objects_of(self, trace: int) -> tuple[str, ...]:
        """The names of a trace's objects."""
        return tuple(self.objects[self.starts[trace] : self.starts[trace + 1]])

    def shape_of(self, trace: int) -> tuple[object, ...]:
        """Equal for traces of the same step, end, types and presence; not of length and names."""
        there = slice(self.starts[trace], self.starts[trace + 1])
        types = tuple(self.types[there])
        stretches = self.stretches[there].tobytes()
        return float(self.step_s[trace]), self.ends[trace], types, stretches


def outlined(block: Block) -> BlockPresence:
    """The objects and presence of a block. Raises OddTableError."""
    starts, n_rows = block.starts, int(block.starts[-1])
    names = _names(block.columns[TRACE])
    trace = np.repeat(np.arange(len(block)), np.diff(starts))
    step = _steps(block.columns[STEP])
    is_first = np.zeros(n_rows, dtype=bool)
    is_first[starts[:-1]] = True
    onward = np.diff(step, prepend=0)
    in_order = not step[is_first].any() and (is_first | (onward == 0) | (onward == 1)).all()
    if (names.codes < 0).any() or not in_order:
        raise OddTableError
    length = step[starts[1:] - 1] + 1

    nothing = Coded(np.full(n_rows, -1), ())
    items = _names(block.columns.get(OBJECT, nothing))
    types = _names(block.columns.get(TYPE, nothing))
    others = _names(block.columns.get(OTHER, nothing))
    is_about = items.given
    if (types.given & ~is_about).any() or (others.given & ~is_about).any():
        raise OddTableError
    rows = np.flatnonzero(is_about)
    which = _ObjectNumbers.of(trace[rows], items.codes[rows], len(block), len(items.values))
    first_row, numbers = rows[which.first], which.numbers
    owner = trace[first_row]
    starts_of_objects = np.searchsorted(owner, np.arange(len(block) + 1))

    item = np.full(n_rows, NOBODY)
    item[rows] = numbers - starts_of_objects[trace[rows]]
    kind, given = types.codes[first_row], types.codes[rows]
    if (kind < 0).any() or ((given != kind[numbers]) & (given >= 0)).any():
        raise OddTableError
    # Rows are in the order of steps.
    last_row = np.zeros(len(first_row), dtype=np.int64)
    last_row[numbers] = rows
    stretches = np.stack([step[first_row], step[last_row]], axis=1)
    is_always = (stretches[:, 0] == 0) & (stretches[:, 1] == length[owner] - 1)
    stretches[is_always] = NOBODY
    return BlockPresence(
        trace=trace,
        step=step,
        item=item,
        other=_others(others, items, trace, which, starts_of_objects),
        names=[names.values[code] for code in names.codes[starts[:-1]].tolist()],
        length=length,
        step_s=_step_s(block.columns.get(STEP_S), trace, starts),
        ends=_ends(block.columns, trace, len(block)),
        starts=starts_of_objects,
        objects=[items.values[code] for code in items.codes[first_row].tolist()],
        types=[types.values[code] for code in kind.tolist()],
        stretches=stretches,
    )


def _outlined_trace(block: Block, outline: BlockPresence, place: int) -> Trace | None:
    """A trace made from its columns; None if a value is given twice."""
    start, stop = block.starts[place : place + 2].tolist()
    rows = slice(start, stop)
    steps, names = outline.step[rows].tolist(), outline.objects_of(place)
    items, others = outline.item[rows].tolist(), outline.other[rows].tolist()
    states: list[dict[str, Any]] = [{} for _ in range(int(outline.length[place]))]
    for name, where, values in _values_in_rows(block, start, stop):
        for row, value in zip(where.tolist(), values, strict=True):
            of, last = states[steps[row]], name
            if items[row] != NOBODY:
                of, last = of.setdefault(name, {}), names[items[row]]
                if others[row] != NOBODY and type(of) is dict:
                    of, last = of.setdefault(last, {}), names[others[row]]
            if type(of) is not dict or last in of:
                return None
            of[last] = value
    own = slice(*outline.starts[place : place + 2].tolist())
    step_s = block.columns.get(STEP_S)
    is_said = step_s is not None and step_s.given_at(slice(start, start + 1)).all()
    ((number, _),) = block.rows(start, start + 1)
    return Trace(
        id=outline.names[place],
        step_s=cells_of(step_s, np.array([start]))[0] if step_s and is_said else 1.0,
        objects=dict(zip(names, outline.types[own], strict=True)),
        states=tuple(states),
        present={
            name: (first, last)
            for name, (first, last) in zip(names, outline.stretches[own].tolist(), strict=True)
            if first != NOBODY
        },
        place=block.table.place(number),
        ends=outline.ends[place],
    )


def _values_in_rows(
    block: Block, start: int, stop: int
) -> Iterator[tuple[str, Rows, Sequence[PartialValue]]]:
    """The given values of each name, and their rows counted from ``start``."""
    for name in block.table.names:
        column = block.columns[name]
        where = np.flatnonzero(column.given_at(slice(start, stop)))
        yield name, where, cells_of(column, where + start)
    for name, unknown in block.unknown.items():
        first, last = np.searchsorted(unknown, (start, stop)).tolist()
        yield name, unknown[first:last] - start, [UNKNOWN] * (last - first)


def cells_of(column: Column, rows: Rows) -> list[Any]:
    """A column's values in rows whose cell is not empty."""
    if isinstance(column, Coded):
        return [column.values[code] for code in column.codes[rows].tolist()]
    numbers = column.numbers[rows]
    cells: list[Any] = (numbers.astype(np.int64) if column.whole else numbers).tolist()
    return cells


def _names(column: Column) -> Coded:
    if not isinstance(column, Coded) or not {type(value) for value in column.values} <= {str, int}:
        raise OddTableError
    return Coded(column.codes, [str(value) for value in column.values])


def _steps(column: Column) -> Rows:
    if isinstance(column, Numbers):
        raise OddTableError
    most = len(column.codes)
    if isinstance(column.values, range) and len(column.values) == most:
        if (column.codes < 0).any():
            raise OddTableError
        return column.codes.astype(np.int64, copy=False)
    table = [tables.whole(value) for value in column.values]
    if (column.codes < 0).any() or not all(entry is not None and entry < most for entry in table):
        raise OddTableError
    return np.array(table, dtype=np.int64).take(column.codes)


@dataclass(frozen=True, slots=True, eq=False)
class _ObjectNumbers:
    """Objects numbered in the order of their first rows, among rows that are about an object.

    ``numbers`` are the rows' objects, ``first`` the first row of each object. ``_of_key`` maps keys
    to numbers, -1 for none; a key is the code of a name alone if each name appears in one trace
    only, which is then its ``_owner``.
    """

    numbers: Rows
    first: Rows
    _of_key: Rows
    _owner: Rows | None
    _n_codes: int

    @classmethod
    def of(cls, trace: Rows, codes: NDArray[Any], n_traces: int, n_codes: int) -> _ObjectNumbers:
        """The numbers of the objects in rows of these traces with these codes of names."""
        owner_of_code = np.full(n_codes, -1)
        owner_of_code[codes] = trace
        owner: Rows | None = owner_of_code
        keys, n_keys = codes, n_codes
        if (owner_of_code[codes] != trace).any():
            owner, keys, n_keys = None, trace * n_codes + codes, n_traces * n_codes
            if n_keys > _MOST_KEYS * max(len(keys), 1):
                raise OddTableError
        # Written in reverse, so that each key's first row remains.
        first_of_key = np.full(n_keys, -1)
        first_of_key[keys[::-1]] = np.arange(len(keys))[::-1]
        met = np.flatnonzero(first_of_key >= 0)
        first = first_of_key[met]
        order = np.argsort(first)
        number_of_key = np.full(n_keys, -1)
        number_of_key[met[order]] = np.arange(len(met))
        return cls(number_of_key[keys], first[order], number_of_key, owner, n_codes)

    def of_others(self, trace: Rows, codes: NDArray[Any]) -> Rows:
        """The numbers of the objects that these codes name in these traces; -1 for none."""
        if not len(self.first):
            return np.full(len(trace), -1)
        if self._owner is None:
            return np.where(codes < 0, -1, self._of_key[trace * self._n_codes + codes])
        return np.where((codes < 0) | (self._owner[codes] != trace), -1, self._of_key[codes])


_MOST_KEYS = 64
"""The limit of pairs of trace and name to be numbered, as a multiple of the rows."""


def _others(
    others: Coded,
    items: Coded,
    trace: Rows,
    which: _ObjectNumbers,
    starts: NDArray[np.int64],
) -> Rows:
    result = np.full(len(trace), NOBODY)
    rows = np.flatnonzero(others.given)
    if not len(rows):
        return result
    places = {name: place for place, name in enumerate(items.values)}
    codes = np.array([places.get(name, -1) for name in others.values]).take(others.codes[rows])
    numbers = which.of_others(trace[rows], codes)
    if (numbers < 0).any():
        raise OddTableError
    result[rows] = numbers - starts[trace[rows]]
    return result


def _step_s(column: Column | None, trace: Rows, starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Each trace's step (s), given in all rows of the block or in none; else OddTableError."""
    n_traces = len(starts) - 1
    if column is None or not column.given.any():
        return np.ones(n_traces)
    if not column.given.all():
        raise OddTableError
    if isinstance(column, Numbers):
        seconds = column.numbers
    elif {type(value) for value in column.values} <= {int, float}:
        seconds = np.array(column.values, dtype=np.float64).take(column.codes)
    else:
        raise OddTableError
    result = seconds[starts[:-1]]
    if not ((result > 0) & np.isfinite(result)).all() or (seconds != result[trace]).any():
        raise OddTableError
    return result


def _ends(columns: Mapping[str, Column], trace: Rows, n_traces: int) -> Sequence[Ending]:
    """How each trace ends, given in some of its rows or in none. Raises OddTableError."""
    step_s, said = columns.get(STEP_S), columns.get(ENDS, Coded(np.full(len(trace), -1), ()))
    if isinstance(said, Numbers) or not {*said.values} <= {*get_args(Ending)}:
        raise OddTableError
    rows = np.flatnonzero(said.given)
    code_of = np.full(n_traces, -1)
    code_of[trace[rows]] = said.codes[rows]
    if (code_of[trace[rows]] != said.codes[rows]).any():
        raise OddTableError
    unsaid = ending_in_file(None, in_seconds=step_s is not None and bool(step_s.given.any()))
    return [unsaid if code < 0 else said.values[code] for code in code_of.tolist()]
