"""Files of traces: their formats, reading and writing."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from pathlib import Path, PurePath
from typing import IO, Any, Literal

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.fault_messages import contained
from rulec.files.read_files import opened
from rulec.trace.formats import json_lines
from rulec.trace.formats.arrow.parquet import read_parquet, write_parquet
from rulec.trace.formats.csv_table import read_csv, write_csv
from rulec.trace.formats.table_reader import ENDS, FROM, OWN, PARTIAL, TO, TOLD, UNKNOWN_NAMES
from rulec.trace.trace_messages import NOT_A_TRACE
from rulec.trace.trace_model import State, Trace, plain_step_s
from rulec.value_display import brief
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue, UnknownValue

Format = Literal["jsonl", "csv", "parquet"]

Kinds = Mapping[str, type]
"""The type of each name's values in states: ``bool``, ``float`` or ``str``.

An interval's bounds have names of their own, as they have columns of their own in tables.
"""


def format_of(file: str) -> Format:
    """The format by a file name's ending, without `.gz`; JSON Lines if it is another."""
    match PurePath(file.lower().removesuffix(".gz")).suffix:
        case ".csv":
            return "csv"
        case ".parquet" | ".pq":
            return "parquet"
    return "jsonl"


def read_traces(path: str | Path, form: Format | None = None) -> Iterator[Trace | RulecError]:
    """Read the traces of a file; without ``form``, the file name's ending decides the format.

    A bad trace is replaced by the RulecError that says why.
    """
    with opened(Path(path)) as stream:
        for chunk in read_chunks(stream, str(path), form or format_of(str(path))):
            yield from chunk


def read_chunks(
    stream: IO[bytes], file: str, form: Format
) -> Iterator[Sequence[Trace | RulecError]]:
    """Read the traces of a stream in chunks; chunks of a table may be a ``Block``.

    A bad trace is replaced by the RulecError that says why. Raises RulecError R0706 if Parquet
    cannot be read.
    """
    with contained("not read", SourceLocation(file)):
        if form == "jsonl":
            yield from json_lines.read_chunks(stream, file)
        else:
            yield from (read_csv if form == "csv" else read_parquet)(stream, file)


def write_traces(
    traces: Iterable[Trace],
    stream: IO[bytes],
    file: str,
    form: Format,
    kinds: Kinds,
    *,
    partial: bool = False,
) -> None:
    """Write traces; ``kinds`` are the types of all names in them.

    ``partial``: tables get columns for what is unknown. Raises RulecError R0706 if Parquet cannot
    be written here, ValueError if a name cannot be a column.
    """
    if form == "jsonl":
        json_lines.write_traces(traces, stream)
        return
    columns = columns_for(kinds)
    if not partial:
        columns = [name for name in columns if name not in PARTIAL or name == ENDS]
    elif form == "csv":
        columns.remove(UNKNOWN_NAMES)  # `?` says it
    rows = chain.from_iterable(rows_of(trace, columns) for trace in traces)
    own = {"step": int, "step_s": float, TOLD: list, UNKNOWN_NAMES: list}
    types = [(name, kinds.get(name) or own.get(name, str)) for name in columns]
    try:
        if form == "csv":
            write_csv(rows, columns, stream)
        else:
            write_parquet(rows, types, stream, file)
    except UnicodeEncodeError:
        why = "a trace has half a character (a surrogate), which no file can hold"
        raise NOT_A_TRACE.error(SourceLocation(file), why) from None


_WRITABLE = (bool, int, float, str, Interval, UnknownValue)


def check_writable(trace: Trace) -> None:
    """Refuse values that no format of traces can hold. Raises RulecError R0501."""
    for pair in trace.objects.items():
        if not all(isinstance(text, str) for text in pair):
            message = f"`objects` has names and types, not {brief(pair[0])} and {brief(pair[1])}"
            raise NOT_A_TRACE.error(trace.place, message)
    for number, state in enumerate(trace.states):
        for name, value in state.items():
            odd = [leave for leave in _leaves(value) if not isinstance(leave, _WRITABLE)]
            if odd or not isinstance(name, str):
                subject = (
                    f"`{name}` is {brief(odd[0])}" if odd else f"the name {brief(name)} is no str"
                )
                message = f"state {number}: {subject}, which no file can hold"
                raise NOT_A_TRACE.error(trace.place, message)


def kinds_in(states: Iterable[State]) -> dict[str, type]:
    """The types of all names that appear in states, in order."""
    kinds: dict[str, type] = {}
    unknown: dict[str, type] = {}
    for state in states:
        for name, value in state.items():
            for leave in _leaves(value):
                if leave is UNKNOWN:
                    unknown[name] = str
                elif isinstance(leave, Interval):
                    kinds |= {name + FROM: float, name + TO: float}
                else:
                    kinds.setdefault(name, float if type(leave) is int else type(leave))
    return {**unknown, **kinds}


def with_bounds(kinds: Kinds, names: Collection[str]) -> dict[str, type]:
    """The types, with those of the bounds of numbers among these names."""
    bounds = {name + end: float for name in kinds if name in names for end in (FROM, TO)}
    return {**kinds, **bounds}


def is_partial(trace: Trace) -> bool:
    """Whether something in a trace is unknown."""
    return trace.told is not None or any(
        leave is UNKNOWN
        for state in trace.states
        for value in state.values()
        for leave in _leaves(value)
    )


def _leaves(value: Any, most_objects: int = 2) -> Iterator[PartialValue]:
    if isinstance(value, Mapping) and most_objects:
        for inner in value.values():
            yield from _leaves(inner, most_objects - 1)
    else:
        yield value


def columns_for(kinds: Kinds) -> list[str]:
    """The columns of a table for these names; ValueError if one is a reserved column."""
    taken = [name for name in kinds if name in OWN]
    if taken:
        raise ValueError(f"`{taken[0]}` is a reserved column and cannot be a name")
    return [*OWN, *kinds]


def rows_of(trace: Trace, columns: Sequence[str]) -> Iterator[list[Any]]:
    """The rows of a trace for ``columns_for`` names: per state, per object, per pair of objects.

    Values about absent objects are omitted; no rule reads them.
    """
    own = [name for name in columns if name in PARTIAL]
    names = columns[len(OWN) - len(PARTIAL) + len(own) :]
    told = None if trace.told is None else sorted(trace.told)
    of_trace = {ENDS: trace.ends, TOLD: told}
    nothing = [None] * len(own)
    first = [of_trace.get(name) for name in own]
    for step, state in enumerate(trace.states):
        start = [trace.id, step, plain_step_s(trace)]

        def row(
            *items: str, start: Sequence[Any] = start, state: State = state, step: int = step
        ) -> list[Any]:
            values = [_about(state, name, items) for name in names]
            about = first if not step and not items else nothing
            if UNKNOWN_NAMES in own:
                unknown = [name for name in state if _about(state, name, items) is UNKNOWN]
                about = [*about[:-1], unknown or None]
                values = [None if value is UNKNOWN else value for value in values]
            kind = trace.objects[items[0]] if items else None
            item, other = (*items, None, None)[:2]
            return [*start, item, kind, other, *about, *values]

        yield row()
        there = [item for item in trace.objects if _is_present(item, step, trace)]
        for item in there:
            yield row(item)
        for item in there:
            beside = _beside(item, state)
            for other in (other for other in there if other in beside):
                values = row(item, other)
                if any(value is not None for value in values[len(OWN) - len(PARTIAL) :]):
                    yield values


def _beside(item: str, state: State) -> set[str]:
    """The other objects that have values together with an object."""
    about: list[Any] = [x.get(item) for x in state.values() if isinstance(x, Mapping)]
    return {other for value in about if isinstance(value, Mapping) for other in value}


def _is_present(item: str, step: int, trace: Trace) -> bool:
    first, last = trace.present.get(item, (0, len(trace.states) - 1))
    return first <= step <= last


def _about(state: State, column: str, items: Sequence[str]) -> PartialValue | None:
    name, _, bound = column.partition(".")
    value: Any = state.get(name)
    for item in items:
        value = value.get(item) if isinstance(value, Mapping) else None
    if isinstance(value, Interval):
        return {"from": value.low, "to": value.high}.get(bound)
    return None if bound or isinstance(value, Mapping) else value
