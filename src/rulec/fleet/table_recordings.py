"""Judge recordings in tables of tracks, as rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePath
from typing import Any

from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import contained
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.files.read_files import FileState, note_read
from rulec.fleet.drive_rows import DriveRows, reason_of
from rulec.fleet.finding_columns import Row
from rulec.fleet.fleet_messages import cut_drive, no_map
from rulec.fleet.table_kind import FILE, MAP, RECORDING, ROWS, SeenKeys, keys_of, lacking
from rulec.recordings.doubts.motion_doubts import with_doubts
from rulec.recordings.doubts.road_doubts import check_near
from rulec.recordings.encodings.table_files import table_of
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Recording
from rulec.recordings.road_map import RoadMap
from rulec.recordings.tracks.roads_of_tracks import track_recording
from rulec.recordings.tracks.track_table import track_rows_of
from rulec.trace.formats import arrow as arrow_tables

Roads = RoadMap | str | None
"""A map already read, or the path of one."""

_MOST_MAPS = 8


@dataclass(frozen=True, slots=True)
class TrackTableJudge:
    """Judges recordings in tables of tracks on ``roads``, or on the map named by the table.

    ``seen`` are recordings seen before; None if tables are grouped by recording.
    """

    to_rows: DriveRows
    request: RequestedDrives
    roads: Roads
    seen: SeenKeys | None
    frame_rate: float | None = None

    def rows(self, table: Any) -> Iterator[Row]:
        """The rows of all drives, recording by recording.

        Raises RulecError R0709 for a recording that is cut, if tables are not grouped by recording.
        """
        keys = keys_of(table.column_names, "tracks")
        for key, rows in arrow_tables.groups(table, keys, []):
            own = dict(zip(keys, key, strict=True))
            own.setdefault(RECORDING, PurePath(own.get(FILE, "")).name or "tracks")
            unread = arrow_tables.not_utf8(rows, rows.column_names)
            lacks = lacking(rows, len(rows))
            if self.seen is not None:
                if not lacks and not unread and self.seen.is_other(key, arrow_tables.extent(rows)):
                    lacks = "other rows of it came before"
                if lacks:
                    raise cut_drive(f"recording `{own[RECORDING]}`", lacks, keys)
            if lacks or unread:
                yield self.to_rows.of_nothing(own, lacks or unread)
            else:
                yield from self._of_recording(rows, own)

    def _of_recording(self, rows: Any, own: Mapping[str, str]) -> Iterator[Row]:
        name, file = own[RECORDING], own.get(FILE, "")
        try:
            with contained():
                recording = recording_of(rows, name, self.roads, self.frame_rate)
                rules = self.to_rows.rules
                verdicts = RecordingVerdicts(recording, rules, self.request, file or name)
                yield from self.to_rows.of_recording(verdicts, file)
        except RulecError as error:
            yield self.to_rows.of_nothing(own, reason_of(error, own))


def recording_of(table: Any, name: str, roads: Roads, frame_rate: float | None = None) -> Recording:
    """The recording of the tracks in an Arrow table.

    Raises RulecError R0610, R0614 without a map, otherwise as ``read_map``.
    """
    maps = table.column(MAP).unique().to_pylist() if MAP in table.column_names else []
    if len(maps) > 1:
        raise no_map(name, f"its rows name {len(maps)} maps")
    known = [column for column in table.column_names if column not in (MAP, ROWS)]
    columns = {column: arrow_tables.cells_in(table.column(column)) for column in known}
    rows, remark = track_rows_of(
        table_of(columns, f"tracks of `{name}`, rows counted in it"), frame_rate
    )
    chosen = maps[0] if maps and maps[0] else roads
    if chosen is None:
        raise no_map(name, "it has tracks, but no roads")
    if isinstance(chosen, str):
        chosen = _map(chosen, rows.times.step_s, note_read(chosen))
    recording = track_recording(name, [rows], chosen, form="tracks as a table", remarks=[remark])
    check_near(recording, None)
    return with_doubts(recording, rows.columns.refused, sure=frame_rate is not None)


@lru_cache(maxsize=_MOST_MAPS)
def _map(path: str, step_s: float, _: FileState | None) -> RoadMap:
    """A map in its current state, read once per process; the times of its lights count steps."""
    return read_map(Path(path), step_s)
