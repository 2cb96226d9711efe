"""Judge the drives of a unit of work, and write their findings to one file."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import contained, fault_of
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.files.read_files import files_read
from rulec.files.written_files import written_whole
from rulec.fleet.carried_rulebook import CarriedRulebook
from rulec.fleet.drive_rows import DriveRows, reason_of
from rulec.fleet.finding_columns import Row, arrow_schema, arrow_table
from rulec.fleet.runs.drive_keys import memory_given_back
from rulec.fleet.runs.fleet_folder import READ, STATE, FleetFolder
from rulec.fleet.runs.fleet_tally import FleetTally, tally_of
from rulec.fleet.runs.unit_slices import slices_of_unit
from rulec.fleet.runs.work_units import WorkUnit
from rulec.fleet.table_kind import TableKind, kind_of
from rulec.fleet.table_recordings import TrackTableJudge
from rulec.fleet.table_traces import TraceTableJudge
from rulec.monitoring.assumptions import Assumptions
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from rulec.resource_limits import BudgetSpentError
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
