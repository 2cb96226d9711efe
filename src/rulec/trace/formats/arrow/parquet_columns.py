"""Columns of any Parquet file as arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files.read_files import opened
from rulec.trace.formats.arrow.parquet import arrow

Refused = Callable[..., RulecError]

_MAGIC, _GLANCE = b"PAR1", 64


def parquet_names(path: Path, refused: Refused) -> tuple[str, ...]:
    """The names of a file's columns.

    Raises RulecError R0706 if pyarrow is missing, R0701 if the file cannot be opened, and otherwise
    the error that ``refused`` makes of the reason.
    """
    with opened(path) as stream:
        start = stream.read(_GLANCE)
        if start and not start.startswith(_MAGIC) and start.isascii() and b"\0" not in start:
            way_out = "if it is CSV, call it `.csv`"
            raise refused("it is not Parquet but text", help_text=way_out)
    pyarrow, parquet = arrow(str(path))
    with opened(path) as stream:
        try:
            return tuple(parquet.ParquetFile(stream).schema_arrow.names)
        except (pyarrow.ArrowException, OSError, ValueError) as reason:
            # Column names that are not UTF-8 raise a ValueError
            raise refused(f"it is not Parquet ({_first(reason)})") from None


def parquet_columns(
    path: Path, names: Sequence[str], refused: Refused, most_rows: int
) -> dict[str, NDArray[Any]]:
    """The named columns of a file, as arrays. Raises RulecError as ``parquet_names`` does."""
    pyarrow, parquet = arrow(str(path))
    with opened(path) as stream:
        try:
            source = parquet.ParquetFile(stream)
            if source.metadata.num_rows > most_rows:
                raise refused(f"it has more than {most_rows:,} rows")
            table = source.read(columns=list(names))
            return {name: table.column(name).to_numpy() for name in names}
        except (pyarrow.ArrowException, OSError, ValueError, TypeError) as reason:
            raise refused(f"it is damaged Parquet ({_first(reason)})") from None


def _first(reason: Exception) -> str:
    return str(reason).split("\n")[0].split(".")[0][:120]
