"""Kind of a table, tracks or traces; whether its drives are complete."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Sequence
from typing import Any, Literal

from rulec.fleet.fleet_messages import no_drives
from rulec.recordings.table_heads import is_track_head
from rulec.trace.formats.table_reader import STEP, TRACE

TableKind = Literal["tracks", "traces"]

FILE, RECORDING, MAP, ROWS = "file", "recording", "map", "rows"
"""Columns that both kinds of tables may have beside their own.

Where a row is from, the map of its recording, and how many rows its recording or trace has.
"""

MOST_SEEN = 1 << 12


def kind_of(columns: Sequence[str]) -> TableKind:
    """What a table with these columns holds. Raises RulecError R0710."""
    names = [name.casefold() for name in columns]
    if TRACE in names and STEP in names:
        return "traces"
    if is_track_head(names):
        return "tracks"
    raise no_drives(list(columns))


def keys_of(columns: Sequence[str], kind: TableKind) -> list[str]:
    """The columns that say which recording, or trace, a row is of."""
    keys = [name for name in (FILE, RECORDING) if name in columns]
    return [*keys, TRACE] if kind == "traces" else keys


def lacking(rows: Any, count: int) -> str:
    """How many rows are missing, in words, if the table says how many there are in all."""
    if ROWS not in rows.column_names:
        return ""
    stated = [value for value in rows.column(ROWS).unique().to_pylist() if value is not None]
    if stated in ([], [count]):
        return ""
    return f"{count:,} of {max(stated):,} rows are there"


class SeenKeys:
    """The drives that a judge has seen last, and what they were like.

    A drive that comes again as it was is judged anew: its worker failed and started again. One that
    comes again with other rows has been cut. Copies for other processes have seen nothing.
    """

    def __init__(self) -> None:
        self._seen: OrderedDict[Hashable, Hashable] = OrderedDict()

    def is_other(self, key: Hashable, content: Hashable) -> bool:
        """True if a drive with this key was there before, with other content."""
        before = self._seen.setdefault(key, content)
        if len(self._seen) > MOST_SEEN:
            self._seen.popitem(last=False)
        return before != content

    def __reduce__(self) -> tuple[type[SeenKeys], tuple[()]]:
        return SeenKeys, ()
