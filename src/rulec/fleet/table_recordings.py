"""Judge recordings in tables of tracks, and traces in tables, as rows."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePath
from typing import Any, Literal

from rulec.diagnostics import RulecError, nearest_name
from rulec.diagnostics.fault_messages import contained
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.files.read_files import FileState, note_read
from rulec.fleet.drive_rows import DriveRows, reason_of
from rulec.fleet.finding_columns import Row
from rulec.fleet.fleet_messages import almost_named, cut_drive, no_drives, no_map, twice_named
from rulec.monitoring.assumptions import Assumptions
from rulec.monitoring.batch.batch_verify import Answer, Items, rulebook_for, verify_items
from rulec.monitoring.moments.drive_facts import facts_of_many
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.recordings.doubts.motion_doubts import with_doubts
from rulec.recordings.doubts.road_doubts import check_near
from rulec.recordings.encodings.table_files import table_of
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Recording
from rulec.recordings.road_map import RoadMap
from rulec.recordings.table_heads import SAME_NAME, is_track_head
from rulec.recordings.tracks.roads_of_tracks import track_recording
from rulec.recordings.tracks.track_table import track_rows_of
from rulec.report.findings.findings_of_traces import trace_findings
from rulec.report.findings.verdict_finding import VerdictFinding
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.table_reader import OBJECT, OTHER, STEP, TRACE
from rulec.trace.trace_model import Trace

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


@dataclass(frozen=True, slots=True)
class TraceTableJudge:
    """Judges traces in tables; ``seen`` as in ``TrackTableJudge``."""

    to_rows: DriveRows
    assumed: Assumptions
    seen: SeenKeys | None

    def rows(self, table: Any) -> Iterator[Row]:
        """The rows of all traces, ordered by name.

        Raises RulecError R0709 for a trace that is cut, if tables are not grouped by trace.
        """
        own = [name for name in keys_of(table.column_names, "traces") if name != TRACE]
        order = [TRACE, STEP, *(x for x in (OBJECT, OTHER) if x in table.column_names)]
        for key, rows in arrow_tables.groups(table, own, order):
            yield from self._of_source(rows, dict(zip(own, key, strict=True)))

    def _of_source(self, rows: Any, own: Mapping[str, str]) -> Iterator[Row]:
        """The rows of the traces from one file and recording."""
        outlines, some_unread = (
            arrow_tables.trace_outlines(rows),
            arrow_tables.not_utf8(rows, rows.column_names),
        )
        is_counted = ROWS in rows.column_names
        cut = []
        for number, outline in enumerate(outlines):
            lacks = outline.lacks
            if not lacks and is_counted:
                lacks = lacking(rows.slice(outline.first, outline.rows), outline.rows)
            if self.seen is not None:
                content = (outline.rows, outline.states)
                if not lacks and self.seen.is_other((*own.values(), outline.name), content):
                    lacks = "other rows of it came before"
                if lacks:
                    raise cut_drive(f"trace `{outline.name}`", lacks, [*own, TRACE])
            if some_unread and not lacks:
                lacks = arrow_tables.not_utf8(
                    rows.slice(outline.first, outline.rows), rows.column_names
                )
            if lacks:
                yield self.to_rows.of_nothing({**own, "vehicle": outline.name}, lacks)
                cut.append(number)
        rest = arrow_tables.without_rows(rows, [outlines[number] for number in cut])
        whole = [whole_trace for number, whole_trace in enumerate(outlines) if number not in {*cut}]
        others = [name for name in (MAP, ROWS) if name in rest.column_names]
        yield from self._judged(rest.drop_columns(others), whole, own)

    def _judged(self, rows: Any, outlines: list[Any], own: Mapping[str, str]) -> Iterator[Row]:
        waiting, file = iter(outlines), own.get(FILE, "") or "the table"
        try:
            with contained():
                for chunk in arrow_tables.traces_of_table(rows, file) if outlines else ():
                    for judged in verify_items(self.assumed.of(chunk), self.to_rows.rules):
                        yield from self._of_traces(*judged, waiting, own)
        except RulecError as error:
            for outline in waiting:
                yield self.to_rows.of_nothing({**own, "vehicle": outline.name}, _why(error))

    def _of_traces(
        self,
        traces: Items,
        answers: Iterable[Answer],
        waiting: Iterator[Any],
        own: Mapping[str, str],
    ) -> Iterator[Row]:
        # Only the reason, not the whole message: a table may contain as many reasons as rows.
        short = [
            _why(answer.error) if isinstance(answer, NotJudged) else answer for answer in answers
        ]
        verdicts = [None if isinstance(answer, str) else answer for answer in short]
        facts = iter(facts_of_many(traces, verdicts, self.to_rows.rules))
        for place, answer in enumerate(short):
            named = {**own, "vehicle": next(waiting).name}
            if isinstance(answer, str):
                yield self.to_rows.of_nothing(named, answer)
                continue
            findings = self._findings(traces, place, answer, own)
            yield from self.to_rows.of_trace(next(facts), answer, named, findings)

    def _findings(
        self, traces: Items, place: int, verdict: Verdict, own: Mapping[str, str]
    ) -> list[VerdictFinding]:
        """The findings of a trace; the trace is built only if there are any."""
        if not verdict.violations and not verdict.open:
            return []
        trace = traces[place]
        assert isinstance(trace, Trace), "it has been judged"
        used = rulebook_for(traces, place, self.to_rows.rules)
        return list(trace_findings(own.get(FILE, ""), trace, verdict, used, []))


def _why(error: RulecError) -> str:
    return error.diagnostics[0].message


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
