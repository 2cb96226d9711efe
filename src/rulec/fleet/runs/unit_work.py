"""Judge the drives of a unit of work, and write their findings to one file.

Rows come in tables of a few whole drives each, so that few are in memory.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, groupby, islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import contained, fault_of
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.files.read_files import files_read
from rulec.files.written_files import written_whole
from rulec.fleet.drive_rows import DriveRows, reason_of
from rulec.fleet.finding_columns import Row, arrow_schema, arrow_table
from rulec.fleet.fleet_judge import CarriedRulebook
from rulec.fleet.fleet_messages import no_fleet_input, other_types
from rulec.fleet.runs.fleet_folder import READ, STATE, FleetFolder, FleetTally, tally_of
from rulec.fleet.runs.work_units import (
    KeyedRows,
    TablePiece,
    WorkUnit,
    keyed_rows,
    memory_given_back,
    opened_table,
)
from rulec.fleet.table_recordings import TableKind, TraceTableJudge, TrackTableJudge, kind_of
from rulec.monitoring.assumptions import Assumptions
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from rulec.resource_limits import BudgetSpentError
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.arrow.parquet import arrow
from rulec.trace.trace_model import Ending

_ROWS_AT_ONCE = 1 << 14


@dataclass(frozen=True, slots=True)
class UnitWorker:
    """Judges units and writes their findings; it is sent to the workers of an engine.

    ``source`` says how to read recordings; its path is replaced.
    """

    rules: CarriedRulebook
    request: RequestedDrives
    source: RecordingSource
    ends: Ending | None
    folder: FleetFolder

    def judged(self, unit: WorkUnit) -> FleetTally:
        """Write a unit's file unless it exists; return the sums over its content.

        The file appears whole, and has the same content however often it is written.
        """
        path = self.folder.part(unit)
        try:
            with memory_given_back():
                if not self.folder.is_done(unit):
                    self._write(unit, path)
                return tally_of(path)
        except Exception as problem:
            fault = fault_of(problem, unit.path).diagnostics[0].message
            return FleetTally(faults=Counter([fault]))

    def _write(self, unit: WorkUnit, path: Path) -> None:
        _, parquet = arrow(str(path))
        state, rows = unit.state(), self.rows(unit)
        with (
            files_read() as read,
            written_whole(path) as stream,
            parquet.ParquetWriter(
                stream, arrow_schema(), compression="zstd", write_page_checksum=True
            ) as writer,
        ):
            while len(table := arrow_table(islice(rows, _ROWS_AT_ONCE))):
                writer.write_table(table)
            beside = {name: then for name, then in sorted(read.items()) if name not in unit.paths}
            writer.add_key_value_metadata({STATE: state, READ: json.dumps(beside)})

    def rows(self, unit: WorkUnit) -> Iterator[Row]:
        """The rows of a unit; for what cannot be read, a row with the reason."""
        to_rows = DriveRows(self.rules.read(), self.folder.by)
        try:
            with contained():
                yield from self._rows(unit, to_rows)
        except BudgetSpentError:
            raise
        except RulecError as error:
            own = {"file": unit.path}
            yield to_rows.of_nothing(own, reason_of(error, own))

    def _rows(self, unit: WorkUnit, to_rows: DriveRows) -> Iterator[Row]:
        if unit.piece is not None:
            yield from self._of_table(unit, to_rows)
            return
        for recording in read_recordings(replace(self.source, path=Path(unit.path))):
            own = {"file": unit.path, "recording": recording.name}
            try:
                with contained():
                    verdicts = RecordingVerdicts(recording, to_rows.rules, self.request, unit.path)
                    yield from to_rows.of_recording(verdicts, unit.path)
            except BudgetSpentError:
                raise
            except RulecError as error:
                yield to_rows.of_nothing(own, reason_of(error, own))

    def _of_table(self, unit: WorkUnit, to_rows: DriveRows) -> Iterator[Row]:
        roads = None if self.source.map_path is None else str(self.source.map_path)
        assumed = Assumptions(self.ends, self.request.assumed, self.request.defaults)
        judges: Mapping[TableKind, TrackTableJudge | TraceTableJudge] = {
            "tracks": TrackTableJudge(to_rows, self.request, roads, None, self.source.frame_rate),
            "traces": TraceTableJudge(to_rows, assumed, None),
        }
        slices = slices_of_unit(unit)
        while (table := next(slices, None)) is not None:
            rows = judges[kind_of(table.column_names)].rows(table)
            # This is the only reference: the table is freed before the next one is read.
            del table
            yield from rows


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
