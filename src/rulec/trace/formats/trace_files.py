"""Files of traces: formats, reading and writing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path, PurePath
from typing import IO, Literal, get_args

from rulec.diagnostics import RulecError
from rulec.files import opened
from rulec.trace.formats import json_lines
from rulec.trace.formats.arrow.parquet import read_parquet, write_parquet
from rulec.trace.formats.csv_table import read_csv, write_csv
from rulec.trace.formats.table_writer import Kinds, columns_for, rows_of
from rulec.trace.trace_model import Trace

Format = Literal["jsonl", "csv", "parquet"]
FORMATS: tuple[Format, ...] = get_args(Format)


def format_of(file: str) -> Format:
    """Format by the ending of a file's name, else JSON Lines."""
    match PurePath(file).suffix.lower():
        case ".csv":
            return "csv"
        case ".parquet" | ".pq":
            return "parquet"
    return "jsonl"


def read_traces(path: str | Path) -> Iterator[Trace | RulecError]:
    """Read the traces of a file one by one.

    In place of a bad one stands the RulecError that says why.

    The end of its name says its format: `.csv`, `.parquet`, anything else is JSON Lines.
    """
    with opened(Path(path)) as stream:
        for chunk in read_chunks(stream, str(path), format_of(str(path))):
            yield from chunk


def read_chunks(
    stream: IO[bytes], file: str, form: Format
) -> Iterator[Sequence[Trace | RulecError]]:
    """Read the traces of a stream in chunks.

    In place of a bad one stands the RulecError that says why.

    Of a table they may be a ``Block``.

    Raises RulecError R0706 for Parquet that cannot be read here.
    """
    if form == "jsonl":
        yield from json_lines.read_chunks(stream, file)
        return
    if form == "parquet":
        yield from read_parquet(stream, file)
        return
    yield from read_csv(stream, file)


def write_traces(
    traces: Iterable[Trace], stream: IO[bytes], file: str, form: Format, kinds: Kinds
) -> None:
    """Write traces; ``kinds`` are those of all names that they speak of.

    Raises:
        RulecError: R0706 if Parquet cannot be written here.
        ValueError: if a name cannot be a column.
    """
    if form == "jsonl":
        json_lines.write_traces(traces, stream)
        return
    columns = columns_for(kinds)
    rows = chain.from_iterable(rows_of(trace, list(kinds)) for trace in traces)
    if form == "csv":
        write_csv(rows, columns, stream)
        return
    own = {"step": int, "step_s": float}
    types = [(name, kinds.get(name) or own.get(name, str)) for name in columns]
    write_parquet(rows, types, stream, file)
