"""Verbs about traces and recorded traffic: read, write, verify."""

# Imports within functions: all that these verbs need takes 150 ms, a session alone 25 ms.

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, get_args, overload

from rulec.api.session_settings import SessionSettings
from rulec.diagnostics import RulecError
from rulec.diagnostics.argument_kinds import expected_fields, finite
from rulec.files.written_files import written_whole
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from rulec.api.judged_drives import JudgedDrives, JudgedTraces
    from rulec.api.rulebook_compilation import Rules
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.extraction.moment_search import DriveMoments
    from rulec.extraction.recording_verdicts import RecordingVerdicts
    from rulec.extraction.selection import RequestedDrives
    from rulec.monitoring.assumptions import Assumptions
    from rulec.monitoring.batch.cell_verdicts import VerdictColumns
    from rulec.monitoring.verdict import NotJudged, Verdict
    from rulec.rates.drive_counts import GroupKey
    from rulec.rates.rule_rates import ViolationRates
    from rulec.recordings.recording import Recording
    from rulec.report.pictures.drawing.picture_formats import Format as PictureFormat
    from rulec.report.pictures.drawing.styles import Theme
    from rulec.report.recordings.format_listing import ListedFormat
    from rulec.scoring.scores import Scores
    from rulec.scoring.traffic_world import TrafficWorld
    from rulec.trace.trace_columns import TraceCells, TraceColumns


class TraceVerbs(SessionSettings):
    """The verbs of a session that are about traces."""

    def read_traces(self, path: str | Path) -> Iterator[Trace | RulecError]:
        """Read the traces of a file: ``.csv``, ``.parquet``, else JSON Lines; lazily.

        A RulecError takes the place of an invalid trace.
        """
        from rulec.trace.formats.trace_files import read_traces

        return read_traces(path)

    def write_traces(self, traces: Iterable[Trace], path: str | Path) -> None:
        """Write traces in the format given by the file's name. Raises RulecError."""
        from rulec.trace.formats.trace_files import (
            check_writable,
            format_of,
            is_partial,
            kinds_in,
            write_traces,
        )

        listed = list(traces)
        for trace in listed:
            check_trace(trace)
            check_writable(trace)
        kinds = kinds_in(state for trace in listed for state in trace.states)
        partial = any(map(is_partial, listed))
        form = format_of(str(path))
        with written_whole(Path(path)) as stream:
            write_traces(iter(listed), stream, str(path), form, kinds, partial=partial)

    @overload
    def verify(
        self, drives: Trace, rules: Rules, assumptions: Assumptions | None = None
    ) -> Verdict: ...

    @overload
    def verify(
        self,
        drives: str | Path | Recording,
        rules: Rules,
        assumptions: Assumptions | None = None,
        *,
        wanted: RequestedDrives | None = None,
        map_path: str | Path | None = None,
    ) -> JudgedDrives | JudgedTraces: ...

    def verify(
        self,
        drives: Trace | str | Path | Recording,
        rules: Rules,
        assumptions: Assumptions | None = None,
        *,
        wanted: RequestedDrives | None = None,
        map_path: str | Path | None = None,
    ) -> Verdict | JudgedDrives | JudgedTraces:
        """Judge a trace, or all drives of a recording or a file, by every rule.

        ``assumptions`` give values for what is unknown in traces, and say how they end; ``wanted``
        and ``map_path`` are for recordings, as for ``verify_recording``. A trace has a ``Verdict``;
        anything else has all verdicts by name, with findings as rows. These stay in memory:
        ``verify_many`` and ``verify_recording`` give them one by one.

        Raises:
            RulecError: R0501 to R0508 if the trace is invalid, or the rules cannot judge it; for a
                file or recording what ``read_traces`` and ``verify_recording`` raise.
        """
        from rulec.monitoring.assumptions import check_assumed
        from rulec.monitoring.batch.by_states import verify_contained
        from rulec.monitoring.rulebook_edition import edition_of
        from rulec.monitoring.verify import verify

        compiled = self._compiled(rules)
        if not isinstance(drives, Trace):
            return self._judged(drives, compiled, assumptions, wanted, map_path=map_path)
        trace = drives
        if assumptions is not None:
            check_assumed(assumptions.values, compiled.vocabulary, "values")
            trace = assumptions.applied(trace)
        return replace(verify_contained(trace, compiled, verify), law=edition_of(compiled))

    def _judged(
        self,
        drives: str | Path | Recording,
        compiled: CompiledRulebook,
        assumptions: Assumptions | None,
        wanted: RequestedDrives | None,
        *,
        map_path: str | Path | None,
    ) -> JudgedDrives | JudgedTraces:
        """What is found in a recording or a file. Raises RulecError, ValueError."""
        from rulec.api.judged_drives import JudgedDrives, JudgedTraces
        from rulec.extraction.selection import RequestedDrives
        from rulec.monitoring.assumptions import check_assumed
        from rulec.recordings.recording import Recording
        from rulec.recordings.recording_files import is_recording

        if isinstance(drives, Recording) or is_recording(str(drives)):
            if assumptions is not None:
                raise ValueError("`assumptions` are for traces; a recording takes `wanted`")
            read = (
                drives if isinstance(drives, Recording) else self.read_recording(drives, map_path)
            )
            file = drives.name if isinstance(drives, Recording) else str(drives)
            return JudgedDrives(read, compiled, wanted or RequestedDrives(), file)
        if wanted is not None or map_path is not None:
            raise ValueError("`wanted` and `map_path` are for recordings; this is a file of traces")
        traces = list(self.read_traces(drives))
        if assumptions is not None:
            check_assumed(assumptions.values, compiled.vocabulary, "values")
            traces = [assumptions.of([item])[0] for item in traces]
        return JudgedTraces(traces, compiled, str(drives))

    def verify_many(
        self,
        traces: Iterable[Trace | RulecError],
        rules: Rules,
        assumptions: Assumptions | None = None,
    ) -> Iterator[Verdict | NotJudged]:
        """Judge many traces fast, and yield their verdicts in order.

        A ``NotJudged`` takes the place of a verdict that cannot be given.
        """
        from rulec.monitoring.assumptions import check_assumed
        from rulec.monitoring.batch.batch_verify import verify_many
        from rulec.monitoring.rulebook_edition import edition_of
        from rulec.monitoring.verdict import with_law

        compiled = self._compiled(rules)
        law = edition_of(compiled)
        if assumptions is not None:
            check_assumed(assumptions.values, compiled.vocabulary, "values")
            traces = (assumptions.of([item])[0] for item in traces)
        return (with_law(answer, law) for answer in verify_many(traces, compiled))

    def verify_columns(self, columns: TraceColumns, rules: Rules) -> list[Verdict | NotJudged]:
        """Judge traces given as arrays, in their order; their ids are their numbers from 0.

        Raises ValueError for an array that fits no name of the vocabulary, or not the layout.
        """
        from rulec.monitoring.batch.batch_verify import verify_columns

        expected_fields(columns)
        return verify_columns(columns, self._compiled(rules).fitted_to(columns.step_s))

    def verify_cells(self, cells: TraceCells, rules: Rules) -> list[VerdictColumns]:
        """Judge traces whose states are given as numbers of a few distinct states."""
        from rulec.monitoring.batch.cell_verdicts import verify_cells

        return list(verify_cells(cells, self._compiled(rules).fitted_to(cells.step_s)))

    def read_recording(
        self,
        path: str | Path,
        map_path: str | Path | None = None,
        *,
        form: str | None = None,
        scenario_id: str | None = None,
        frame_rate: float | None = None,
    ) -> Recording:
        """Read the recording in a file; ``scenario_id`` selects one of several.

        ``map_path`` is the map for formats that do not contain roads; ``form``, such as ``"sumo"``,
        is for files whose format cannot be detected. ``frame_rate`` (Hz) is for tables with frames
        in the place of times, and to confirm time steps that speeds contradict. Raises RulecError.
        """
        from rulec.recordings.recording_files import read_recording
        from rulec.recordings.recording_format import RecordingSource

        roads = None if map_path is None else Path(map_path)
        return read_recording(RecordingSource(Path(path), roads, form, scenario_id, frame_rate))

    def formats(self) -> tuple[ListedFormat, ...]:
        """The formats of recorded traffic and of maps, with the signals that each can provide."""
        from rulec.report.recordings.format_listing import listed_formats, words_in_order

        return listed_formats(words_in_order())

    def verify_recording(
        self,
        recording: str | Path | Recording,
        rules: Rules,
        wanted: RequestedDrives | None = None,
        map_path: str | Path | None = None,
    ) -> RecordingVerdicts:
        """Judge the drives of recorded vehicles, each in turn as ego.

        ``recording`` is a file (``map_path`` has its roads if it contains none), or a recording
        already read, with its roads; ``wanted`` selects drives, thresholds and assumptions.

        Raises:
            RulecError: R0507 if the rules do not fit the step, R0612 for an unknown vehicle, R0610
                for a file that is not a recording.
            TypeError: for anything other than a file or a recording, such as a data frame.
        """
        from rulec.extraction.recording_verdicts import RecordingVerdicts
        from rulec.extraction.selection import RequestedDrives

        file = recording if isinstance(recording, str | Path) else recording.name
        if isinstance(recording, str | Path):
            recording = self.read_recording(recording, map_path)
        compiled = self._compiled(rules)
        request = wanted or RequestedDrives()
        return RecordingVerdicts(recording, compiled, request, str(file), says_law=True)

    judge_recording = verify_recording

    def score(
        self,
        candidates: ArrayLike,
        world: TrafficWorld,
        rules: Rules,
        after: ArrayLike | None = None,
    ) -> Scores:
        """Judge sampled futures of ego in a world, each like a recorded drive.

        ``candidates`` is an array of three axes: candidate, state, and x, y (m), heading (rad) and
        speed (m/s) of ego's middle, one state for each step after the world's present. ``after``
        are the states that lead up to it, the last one being the present, such as ``world.past``.
        What these violate by themselves is not charged; by such rules a candidate is judged anew.

        Raises:
            RulecError: R0780 for invalid arrays, R0507 for rules compiled for another step than the
                world's.
        """
        from rulec.scoring.score import score

        return score(candidates, world, self._compiled(rules), after)

    def find(
        self,
        formula: str,
        drives: str | Path | Recording | Iterable[Trace | RulecError],
        rulebook: str | Path = "",
        wanted: RequestedDrives | None = None,
        map_path: str | Path | None = None,
        *,
        vocabulary: str = "",
    ) -> Iterator[DriveMoments | RulecError]:
        """Find the moments at which a formula holds in drives: of a file, a recording, or traces.

        The formula starts with its variables, as in ``(v: vehicle) gap(v) < 5 m``. It uses the
        names of a ``vocabulary`` (``road`` if neither is given), of a ``rulebook``, with its
        definitions, or of both. ``wanted`` and ``map_path`` are as for ``verify_recording``. A
        RulecError takes the place of a trace that cannot be searched.

        Raises:
            RulecError: for an invalid formula, a file that cannot be read, and what
                ``verify_recording`` raises for recordings.
        """
        from rulec.extraction.moment_search import in_recordings, in_traces
        from rulec.extraction.selection import RequestedDrives
        from rulec.monitoring.assumptions import Assumptions, check_assumed
        from rulec.recordings.recording import Recording
        from rulec.recordings.recording_files import is_recording, read_recordings
        from rulec.recordings.recording_format import RecordingSource
        from rulec.rulebook.query_reader import read_query

        words = {"rulebook": str(rulebook), "vocabulary": vocabulary}
        query = read_query(formula, **words, search_path=self.search_path, at=self.at)
        request = wanted or RequestedDrives()
        if isinstance(drives, Recording):
            return in_recordings([drives], query, request, drives.name)
        assumed = Assumptions(None, request.assumed, request.defaults)
        check_assumed(request.assumed, query.vocabulary)
        if not isinstance(drives, str | Path):
            return in_traces(drives, query, assumed, "")
        if not is_recording(str(drives)):
            return in_traces(self.read_traces(drives), query, assumed, str(drives))
        roads = None if map_path is None else Path(map_path)
        recordings = read_recordings(RecordingSource(Path(drives), roads))
        return in_recordings(recordings, query, request, str(drives))

    def rates_of_findings(
        self,
        findings: str | Path | Sequence[str | Path],
        by: GroupKey | Sequence[GroupKey] = (),
        *,
        confidence: float = 0.95,
        seed: int = 0,
    ) -> ViolationRates:
        """How often rules are violated, with intervals, from files and folders of findings.

        These are written by ``rulec verify --exposure -o FILE`` and ``rulec fleet``. ``by`` are the
        keys by which drives are grouped, ``seed`` is the seed of the bootstrap.

        Raises:
            RulecError: R0701, R0706, R0715 if drives were judged differently, R0716 for files
                without such rows, R0717 without the extra ``rates``.
        """
        from rulec.rates.drive_counts import GroupKey as Known
        from rulec.rates.rates_of_findings import rates_of_findings

        by = (by,) if isinstance(by, str) else by
        known = get_args(Known)
        if unknown := [name for name in by if name not in known]:
            raise ValueError(f"drives are grouped by {', '.join(known)}, not by {unknown[0]!r}")
        if not 0 < confidence < 1:
            raise ValueError(f"`confidence` is between 0 and 1, such as 0.95, not {confidence}")
        paths = [findings] if isinstance(findings, str | Path) else findings
        return rates_of_findings([*map(str, paths)], by, confidence=float(confidence), seed=seed)

    def draw_drive(
        self,
        recording: str | Path | Recording,
        rules: Rules,
        ego: str = "",
        wanted: RequestedDrives | None = None,
        map_path: str | Path | None = None,
        *,
        only: Sequence[str] = (),
        at_s: float | None = None,
        form: PictureFormat = "svg",
        theme: Theme = "auto",
    ) -> bytes:
        """Draw a recorded drive from above, at its first violation or at a time of the recording.

        ``ego`` is a vehicle, or a drive such as ``373#2``; if empty it is the vehicle with the
        earliest violation. ``only`` are the names of the rules whose violations are shown, all if
        empty. A page (``"html"``) has all moments. PNG and PDF require the extra ``pictures``.

        Raises:
            RulecError: R0612 for an unknown drive, R0707 for a file that cannot be made, and what
                ``verify_recording`` raises.
        """
        from rulec.api.pictures import drive_drawing
        from rulec.extraction.selection import RequestedDrives
        from rulec.report.pictures.drawing.picture_formats import as_bytes

        finite("at_s", at_s)
        vehicle, part, _ = ego.partition("#")
        request = replace(wanted or RequestedDrives(), egos=(vehicle,) if vehicle else ())
        verdicts = self.verify_recording(recording, rules, request, map_path)
        known = {rule.name for rule in verdicts.rules.rules}
        if unknown := [name for name in only if name not in known]:
            raise ValueError(f"`only` has {unknown[0]!r}: {verdicts.rules.name} has no such rule")
        trace = ego if part else ""
        drawing = drive_drawing(verdicts, trace, frozenset(only) if only else None, at_s)
        return as_bytes(drawing, form, verdicts.recording.name, theme)
