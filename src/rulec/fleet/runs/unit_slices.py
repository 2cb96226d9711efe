"""The rows of a unit in tables of a few whole drives each, so that few rows are in memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate, groupby
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.fleet.fleet_messages import no_fleet_input, other_types
from rulec.fleet.runs.drive_keys import KeyedRows, keyed_rows, opened_table
from rulec.fleet.runs.work_units import TablePiece, WorkUnit
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.arrow.parquet import arrow

MOST_TOGETHER = 1 << 15
"""Number of rows judged together at most; a longer drive is judged whole."""

_FEWEST_MERGED = 1 << 16


class _Drives(NamedTuple):
    """The drives of a unit: their hashes, row counts, and the index of each one's first row."""

    hashes: NDArray[np.int64]
    rows: NDArray[np.int64]
    first: NDArray[np.int64]


class _Group(NamedTuple):
    """A row group: its file, its index in the file, and its range of rows in the unit."""

    path: str
    number: int
    start: int
    stop: int


class _Place(NamedTuple):
    """A batch of rows: the index of its row group in the unit, and of its first row."""

    group: int
    start: int
    batch: KeyedRows


def slices_of_unit(unit: WorkUnit) -> Iterator[Any]:
    """The rows of a unit's drives as Arrow tables of whole drives.

    Drives are ordered by their first rows. A table has at most ``MOST_TOGETHER`` rows, or one
    drive. The rows of a drive are found wherever they are; if each drive's rows are contiguous,
    each row is read once. Raises RulecError R0710.
    """
    assert unit.piece is not None, "it is of a table"
    reader = _Reader(_groups(unit.piece, *unit.further))
    drives = _drives_of(unit)
    for own in _together(drives.rows):
        first, wanted = int(drives.first[own.start]), int(drives.rows[own].sum())
        # Not bound to a name, so that it is freed before the next one is read.
        yield _one_table(list(reader.rows_of(drives.hashes[own], first, wanted)), unit.path)


def _one_table(parts: Sequence[Any], path: str) -> Any:
    pyarrow, _ = arrow(path)
    try:
        return arrow_tables.joined(parts)
    except pyarrow.ArrowException as reason:
        raise other_types(path, str(reason).split("\n")[0]) from None


def _groups(*pieces: TablePiece) -> list[_Group]:
    groups: list[_Group] = []
    start = 0
    for piece in pieces:
        with opened_table(piece.path) as source:
            sizes = [source.metadata.row_group(number).num_rows for number in piece.row_groups]
        ends = list(accumulate(sizes, initial=start))
        groups += (
            _Group(piece.path, number, *span)
            for number, *span in zip(piece.row_groups, ends[:-1], ends[1:], strict=True)
        )
        start = ends[-1]
    return groups


def _drives_of(unit: WorkUnit) -> _Drives:
    """The drives of a unit, ordered by their first rows."""
    assert unit.piece is not None, "it is of a table"
    others, spread = (
        np.fromiter(keys, np.uint64, len(keys)) for keys in (unit.others, unit.spread)
    )
    parts: list[_Drives] = []
    start = waiting = 0
    for number, piece in enumerate((unit.piece, *unit.further)):
        with opened_table(piece.path) as source:
            for batch in keyed_rows(source, piece.row_groups, piece.path, whole=False):
                which = spread if number else others
                # From the first piece all drives except the others, from further pieces only the
                # spread ones.
                own = np.full(len(batch.texts), not number)
                if len(which):
                    own ^= np.isin(batch.key_hashes(), which)
                rows = np.bincount(batch.codes, minlength=len(own))
                first = np.zeros(len(own), dtype=np.int64)
                # For repeated indices the last assignment wins.
                first[batch.codes[::-1]] = np.arange(start, start + len(batch.codes))[::-1]
                parts.append(_Drives(batch.local_hashes()[own], rows[own], first[own]))
                start += len(batch.codes)
                waiting += len(parts[-1].hashes)
                if waiting > max(_FEWEST_MERGED, 2 * len(parts[0].hashes)):
                    parts, waiting = [_merged(parts)], 0
    drives = _merged(parts)
    order = np.argsort(drives.first)
    return _Drives(drives.hashes[order], drives.rows[order], drives.first[order])


def _merged(parts: Sequence[_Drives]) -> _Drives:
    """The parts as one, with each drive once."""
    hashes, rows, first = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    order = np.argsort(hashes, kind="stable")
    different, starts = np.unique(hashes[order], return_index=True)
    if not len(hashes):
        return _Drives(hashes, rows, first)
    return _Drives(different, np.add.reduceat(rows[order], starts), first[order][starts])


def _together(rows: NDArray[np.int64]) -> Iterator[slice]:
    """Ranges of drives to judge together, given the number of rows of each drive."""
    start = total = 0
    for place, count in enumerate(rows.tolist()):
        if total and total + count > MOST_TOGETHER:
            yield slice(start, place)
            start, total = place, 0
        total += count
    if total:
        yield slice(start, len(rows))


class _Reader:
    """Reads a unit's rows in order, and jumps to a row group where drives are interleaved."""

    def __init__(self, groups: Sequence[_Group]) -> None:
        self._groups = groups
        self._rest: Iterator[_Place] = iter(())
        self._now: _Place | None = None

    def rows_of(self, hashes: NDArray[np.int64], first: int, wanted: int) -> Iterator[Any]:
        """The ``wanted`` number of rows of some drives; ``first`` is the index of the first row."""
        now = self._now
        if now is None or not now.start <= first < self._groups[now.group].stop:
            self._start(first)
            now = next(self._rest, None)
        while now is not None:
            kept = np.isin(now.batch.local_hashes(), hashes)
            count = int(kept[now.batch.codes].sum())
            wanted -= count
            if count:
                yield arrow_tables.rows_where(now.batch.rows, now.batch.codes, kept)
            self._now = now
            if wanted <= 0:
                return
            now = next(self._rest, None)
        raise no_fleet_input(self._groups[0].path, "it has changed while it was read")

    def _start(self, row: int) -> None:
        """Go to the row group that contains a row."""
        group = next(place for place, rows in enumerate(self._groups) if row < rows.stop)
        self._rest = _read_from(self._groups, group)


def _read_from(groups: Sequence[_Group], first: int) -> Iterator[_Place]:
    """The rows of all groups from the index ``first`` on."""
    for path, own in groupby(range(first, len(groups)), lambda place: groups[place].path):
        with opened_table(path) as source:
            for place in own:
                start = groups[place].start
                for batch in keyed_rows(source, [groups[place].number], path, whole=True):
                    yield _Place(place, start, batch)
                    start += len(batch.codes)
