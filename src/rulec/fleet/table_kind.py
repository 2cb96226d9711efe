"""The kind of a table (tracks or traces), and whether its drives are complete."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Hashable, Sequence
from typing import Any, Literal

from rulec.diagnostics import nearest_name
from rulec.fleet.fleet_messages import almost_named, no_drives, twice_named
from rulec.recordings.table_heads import SAME_NAME, is_track_head
from rulec.trace.formats.table_reader import STEP, TRACE

TableKind = Literal["tracks", "traces"]

FILE, RECORDING, MAP, ROWS = "file", "recording", "map", "rows"
"""Columns that both kinds of tables may have in addition.

They contain a row's file, recording, map, and the row count of its recording or trace.
"""

MOST_SEEN = 1 << 12


def kind_of(columns: Sequence[str], path: str = "") -> TableKind:
    """The kind of a table with these columns, from the file at ``path`` if there is one.

    Raises RulecError R0710, also for two columns of one name, and one that is almost called as a
    column that identifies drives.
    """
    name, times = Counter(columns).most_common(1)[0] if columns else ("", 0)
    if times > 1:
        raise twice_named(name, path)
    for name in columns:
        own = nearest_name(name.strip(), (FILE, RECORDING, MAP, ROWS), SAME_NAME)
        if own is not None and own != name and own not in columns:
            raise almost_named(name, own, path)
    names = [name.casefold() for name in columns]
    if TRACE in names and STEP in names:
        return "traces"
    if is_track_head(names):
        return "tracks"
    raise no_drives(list(columns), path)


def keys_of(columns: Sequence[str], kind: TableKind) -> list[str]:
    """The columns that identify the recording or trace of a row."""
    keys = [name for name in (FILE, RECORDING) if name in columns]
    return [*keys, TRACE] if kind == "traces" else keys


def lacking(rows: Any, count: int) -> str:
    """How many rows are missing, as a text; empty if none is or the table has no row count."""
    if ROWS not in rows.column_names:
        return ""
    stated = [value for value in rows.column(ROWS).unique().to_pylist() if value is not None]
    if stated in ([], [count]):
        return ""
    return f"{count:,} of {max(stated):,} rows are there"


class SeenKeys:
    """The drives that a judge saw last, with a summary of their rows.

    A drive that returns unchanged is judged again: its worker failed and was restarted. One that
    returns with other rows has been cut. Copies sent to other processes start empty.
    """

    def __init__(self) -> None:
        self._seen: OrderedDict[Hashable, Hashable] = OrderedDict()

    def is_other(self, key: Hashable, content: Hashable) -> bool:
        """Whether a drive with this key was seen before with other content."""
        before = self._seen.setdefault(key, content)
        if len(self._seen) > MOST_SEEN:
            self._seen.popitem(last=False)
        return before != content

    def __reduce__(self) -> tuple[type[SeenKeys], tuple[()]]:
        return SeenKeys, ()
