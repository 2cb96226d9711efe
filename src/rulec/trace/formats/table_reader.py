"""Traces as rows, one for each state and object (docs/traces.md)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, groupby, islice
from typing import Any, cast, get_args

from rulec.diagnostics import RulecError, SourceLocation, nearest_name
from rulec.diagnostics.diagnostic import as_answer
from rulec.resource_limits import STATES
from rulec.trace.trace_messages import NOT_A_TABLE
from rulec.trace.trace_model import Ending, State, Trace, ending_in_file
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue
from rulec.vocabulary.written_numbers import WrittenNumber

TRACE, STEP, STEP_S = "trace", "step", "step_s"
OBJECT, TYPE, OTHER = "object", "type", "other"
ENDS, TOLD, UNKNOWN_NAMES = "ends", "told", "unknown"
PARTIAL = (ENDS, TOLD, UNKNOWN_NAMES)
"""Columns about what is unknown."""

OWN = (TRACE, STEP, STEP_S, OBJECT, TYPE, OTHER, *PARTIAL)
"""The columns that are not names of a vocabulary."""

FROM, TO = ".from", ".to"
"""Endings of the columns for an interval's bounds."""

NAMES = frozenset((TRACE, STEP, OBJECT, TYPE, OTHER))
"""The columns whose cells identify something."""

LONGEST_ROW = 1 << 23
"""The greatest length of a row in characters, however many lines it spans."""

Row = tuple[int, Sequence[Any]]
"""A row's number, for messages, and its cells; an empty cell is None or the empty text."""

Cell = PartialValue | list[str] | None
"""What can be written into a table."""

_NUMBERS = (int, float, WrittenNumber)

_MOST_REMEMBERED = 1 << 16
_MOST_STATES = 1 << 16


@dataclass(frozen=True)
class Table:
    """How to interpret the rows of a table.

    ``columns`` are the names of all columns. ``value`` turns a non-empty cell into a value,
    ``place`` a row's number into its location. ``has_texts``: all cells are texts.
    """

    columns: tuple[str, ...]
    value: Callable[[Any], PartialValue]
    place: Callable[[int], SourceLocation]
    has_texts: bool = False

    @cached_property
    def at(self) -> dict[str, int]:
        """The index of each column."""
        return {name: place for place, name in enumerate(self.columns)}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The columns that are names of a vocabulary."""
        bounds = {name + end for name in self.intervals for end in (FROM, TO)}
        return tuple(name for name in self.columns if name not in OWN and name not in bounds)

    @cached_property
    def intervals(self) -> dict[str, tuple[int, int]]:
        """Name -> the indices of the columns with its bounds."""
        at = self.at
        names = [name.removesuffix(FROM) for name in at if name.endswith(FROM)]
        return {name: (at[name + FROM], at[name + TO]) for name in names if name + TO in at}

    def cell(self, cells: Sequence[Any], column: str) -> Any:
        """A row's cell in a column; None if there is no such column."""
        place = self.at.get(column)
        return None if place is None else cells[place]


_DEGREES = frozenset({"lat", "latitude", "lon", "lng", "longitude"})
_IN_METRES = (
    "tracks are not read in degrees: "
    "project them to metres in the frame of their map, as `x` and `y`"
)


def check_columns(columns: Sequence[str], place: SourceLocation) -> None:
    """Check (R0509) that columns are named, distinct, and include `trace` and `step`."""
    times = Counter(columns)
    for name in columns:
        if not name:
            raise problem("a column has no name", place, _INDEX if TRACE in times else _FORM)
        if times[name] > 1:
            raise problem(f"there are two columns `{name}`", place)
        for end, other in ((FROM, TO), (TO, FROM)):
            if name.endswith(end) and name.removesuffix(end) + other not in times:
                missing = name.removesuffix(end) + other
                raise problem(f"there is a column `{name}`, but no `{missing}`", place, _BOUNDS)
    for name in (TRACE, STEP):
        if name not in times:
            near = nearest_name(name, columns)
            way_out = _FORM if near is None else f"if `{near}` is meant, rename it to `{name}`"
            if {column.casefold() for column in columns} & _DEGREES:
                way_out = _IN_METRES
            if name == TRACE:
                way_out = f"{way_out}; {_TRACKS}"
            raise problem(f"there is no column `{name}`", place, way_out)


_INDEX = "a cell of the first line is empty; pandas writes such a cell without `index=False`"

_BOUNDS = "an interval needs both bounds, such as 1 and 2.5"

_TRACKS = "tables of recorded traffic have `track`, `t`, `x`, `y` (`--input-format tracks`)"

_FORM = "traces have the columns `trace`, `step`, `object`, `type`, and one for each value"


def problem(message: str, place: SourceLocation, help_text: str = "") -> RulecError:
    """Error R0509: the rows are not traces."""
    return NOT_A_TABLE.error(place, message, help=help_text)


def traces_in(
    rows: Iterable[Row], table: Table, file: SourceLocation
) -> Iterator[Trace | RulecError]:
    """Read the traces of a table; for a bad one, its first mistake.

    If ``rows`` raises a RulecError, that replaces the trace being read. A table without any trace
    gives one RulecError (R0509), about the ``file``.
    """
    known: dict[object, State] = {}
    at = table.at.get(TRACE, 0)
    is_empty_table = True
    most = STATES.value()
    try:
        for name, group in groupby(rows, lambda row: row[1][at] if at < len(row[1]) else None):
            is_empty_table = False
            own = list(islice(group, most + 1))
            if len(own) > most:
                yield STATES.exceeded(table.place(own[0][0]))
            else:
                yield _Building(name, table, known).read(own)
    except RulecError as error:
        # The last trace may have had further rows that cannot be read.
        yield error
        return
    if is_empty_table:
        yield problem("there is no trace in this file", file, _FORM)


@dataclass(slots=True)
class _Building:
    """A trace whose rows are being read."""

    name: Any
    table: Table
    known: dict[object, State]
    states: list[State] = field(default_factory=list)
    objects: dict[str, str] = field(default_factory=dict)
    spans: dict[str, tuple[int, int]] = field(default_factory=dict)
    step_s: float | None = None
    ends: Ending | None = None
    told: frozenset[str] | None = None
    now: list[Row] = field(default_factory=list)

    def read(self, rows: Sequence[Row]) -> Trace | RulecError:
        """The trace of these rows, or their first mistake."""
        try:
            for number, cells in rows:
                self._add(number, cells)
            self._end_state()
        except RulecError as error:
            return as_answer(error)
        always = (0, len(self.states) - 1)
        return Trace(
            id=str(self.name),
            step_s=1.0 if self.step_s is None else self.step_s,
            objects=self.objects,
            states=tuple(self.states),
            present={name: span for name, span in self.spans.items() if span != always},
            place=self.table.place(rows[0][0]),
            ends=ending_in_file(self.ends, in_seconds=self.step_s is not None),
            told=self.told,
        )

    def _add(self, number: int, cells: Sequence[Any]) -> None:
        table = self.table
        if len(cells) != len(table.columns):
            few = "a row needs a cell for every column; has the file been cut short?"
            many = "put a text that contains a comma in quotes"
            raise self._problem(
                f"this row has {len(cells)} cells; there are {len(table.columns)} columns",
                number,
                few if len(cells) < len(table.columns) else many,
            )
        if is_empty(self.name):
            raise self._problem("this row does not name its trace", number)
        self._go_to(cells[table.at[STEP]], number)
        if STEP_S in table.at:
            self._last(cells[table.at[STEP_S]], number)
        if ENDS in table.at:
            self._end(cells[table.at[ENDS]], number)
        if TOLD in table.at:
            self._tell(cells[table.at[TOLD]], number)
        self._appear(cells, number)
        self.now.append((number, cells))

    def _go_to(self, step: Any, number: int) -> None:
        current = len(self.states) if self.now else -1
        step_number = whole(step)
        if step_number is None or step_number not in (max(current, 0), current + 1):
            expected = "0" if current < 0 else f"{current} or {current + 1}"
            raise self._problem(
                f"the step is {_shown(step)}; it must be {expected} here",
                number,
                "a step is a whole number, written without a point: 0, 1, 2"
                if step_number is None and not is_empty(step)
                else "the rows of a trace are consecutive, in the order of its steps, from 0 on",
            )
        if self.now and step_number > current:
            self._end_state()

    def _last(self, step_s: Any, number: int) -> None:
        if is_empty(step_s):
            return
        value = self._value(step_s, number)
        # NaN is not equal to itself.
        if type(value) not in _NUMBERS or value != value:
            raise self._problem(f"`step_s` is {_shown(step_s)}; it must be a number (s)", number)
        if self.step_s is not None and self.step_s != value:
            message = f"`step_s` is {_shown(step_s)}; in the rows before it is {self.step_s:g}"
            raise self._problem(message, number)
        self.step_s = cast("float", value)

    def _end(self, ends: Any, number: int) -> None:
        if is_empty(ends):
            return
        if ends not in get_args(Ending):
            message = f"`ends` is {_shown(ends)}; it must be `complete` or `cut`"
            raise self._problem(message, number)
        if self.ends not in (None, ends):
            raise self._problem(f"`ends` is `{ends}`; before it is `{self.ends}`", number)
        self.ends = ends

    def _tell(self, told: Any, number: int) -> None:
        if is_empty(told):
            return
        names = frozenset(self._names(TOLD, told, number))
        if self.told not in (None, names):
            raise self._problem("`told` has other names in the rows before", number)
        self.told = names

    def _names(self, column: str, cell: Any, number: int) -> list[str]:
        """Names in a cell: a list, or a text with blanks between them."""
        names = cell.split() if isinstance(cell, str) else cell
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise self._problem(f"`{column}` is {_shown(cell)}; it must be a list of names", number)
        return names

    def _appear(self, cells: Sequence[Any], number: int) -> None:
        cell = self.table.cell
        item, kind = cell(cells, OBJECT), cell(cells, TYPE)
        if is_empty(item):
            for column in (TYPE, OTHER):
                if not is_empty(cell(cells, column)):
                    raise self._problem(f"this row has a `{column}`, but no `object`", number)
            return
        name, step = str(item), len(self.states)
        if name not in self.objects:
            if is_empty(kind):
                message = f"the first row of object `{name}` does not give its `type`"
                raise self._problem(message, number)
            self.objects[name] = str(kind)
        elif not is_empty(kind) and str(kind) != self.objects[name]:
            message = f"object `{name}` is of type `{kind}`; before it is of `{self.objects[name]}`"
            raise self._problem(message, number)
        self.spans[name] = (self.spans.get(name, (step, step))[0], step)

    def _end_state(self) -> None:
        at = self.table.at
        columns = [at[name] for name in (OBJECT, OTHER, *self.table.names) if name in at]
        columns += chain.from_iterable(self.table.intervals.values())
        key: tuple[object, ...]
        key = tuple([tuple([cells[column] for column in columns]) for _, cells in self.now])
        if UNKNOWN_NAMES in at:
            unknown = at[UNKNOWN_NAMES]
            key += tuple([str(cells[unknown]) for _, cells in self.now])
        state = self.known.get(key)
        if state is None:
            state = self._state()
            if len(self.known) < _MOST_REMEMBERED:
                self.known[key] = state
        self.states.append(state)
        self.now = []

    def _state(self) -> State:
        table = self.table
        state: dict[str, Any] = {}
        for number, cells in self.now:
            items = [table.cell(cells, column) for column in (OBJECT, OTHER)]
            path = [str(item) for item in items if not is_empty(item)]
            for name in table.names:
                cell = table.cell(cells, name)
                if not is_empty(cell):
                    self._say(state, name, path, self._value(cell, number), number)
            for name, (low, high) in table.intervals.items():
                if not (is_empty(cells[low]) and is_empty(cells[high])):
                    interval = self._interval(name, cells[low], cells[high], number)
                    self._say(state, name, path, interval, number)
            unknown = table.cell(cells, UNKNOWN_NAMES)
            for name in () if is_empty(unknown) else self._names(UNKNOWN_NAMES, unknown, number):
                self._say(state, name, path, UNKNOWN, number)
        return state

    def _say(
        self,
        state: dict[str, Any],
        name: str,
        path: Sequence[str],
        value: PartialValue,
        number: int,
    ) -> None:
        *before, last = (name, *path)
        inner = state
        for key in before:
            inner = inner.setdefault(key, {})
            if not isinstance(inner, dict):
                raise self._repeated_column(name, path, number)
        if last in inner:
            raise self._repeated_column(name, path, number)
        inner[last] = value

    def _interval(self, name: str, low: Any, high: Any, number: int) -> Interval:
        bounds: list[Any] = []
        for end, cell in ((FROM, low), (TO, high)):
            value = None if is_empty(cell) else self._value(cell, number)
            if type(value) not in _NUMBERS:
                message = f"`{name}{end}` is {_shown(cell)}; it must be a number"
                raise self._problem(message, number, _BOUNDS)
            bounds.append(value)
        try:
            return Interval(*bounds)
        except ValueError as wrong:
            raise self._problem(f"`{name}`: {wrong}", number) from None

    def _value(self, cell: Any, number: int) -> PartialValue:
        try:
            return self.table.value(cell)
        except ValueError as wrong:
            raise self._problem(str(wrong), number) from None

    def _repeated_column(self, name: str, path: Sequence[str], number: int) -> RulecError:
        about = f" for `{', '.join(path)}`" if path else ""
        near = nearest_name(name, (column for column in OWN if column not in self.table.at))
        way_out = "" if near is None else f"if `{name}` means `{near}`, rename it"
        return self._problem(
            f"step {len(self.states)} gives `{name}` twice{about}", number, way_out
        )

    def _problem(self, message: str, number: int, help_text: str = "") -> RulecError:
        return problem(message, self.table.place(number), help_text)


def is_empty(cell: Any) -> bool:
    """Whether a cell is empty."""
    return cell is None or cell == ""


def whole(cell: Any) -> int | None:
    """The whole number in a cell, as for a step; None if it contains none."""
    if isinstance(cell, str):
        return int(cell) if cell.isascii() and cell.isdigit() and len(cell) < 19 else None
    return cell if isinstance(cell, int) and not isinstance(cell, bool) else None


def _shown(cell: Any) -> str:
    text = "empty" if is_empty(cell) else f"`{cell}`"
    return text if len(text) <= 60 else f"{text[:60]}…`"


def in_chunks(traces: Iterable[Trace | RulecError]) -> Iterator[list[Trace | RulecError]]:
    """Group traces into lists of about ``_MOST_STATES`` states."""
    chunk: list[Trace | RulecError] = []
    n_states = 0
    for trace in traces:
        chunk.append(trace)
        n_states += len(trace.states) if isinstance(trace, Trace) else 1
        if n_states >= _MOST_STATES:
            yield chunk
            chunk, n_states = [], 0
    if chunk:
        yield chunk
