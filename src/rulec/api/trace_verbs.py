"""Verbs about traces and recorded traffic: read, write, verify."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, get_args, overload

from rulec.api import lazy_imports as lazy
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
    from rulec.monitoring.fault_containment import TraceJudge
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


def _trace_judge() -> TraceJudge:
    """What judges a trace: in arrays, or by its states where there is no NumPy, as in a browser."""
    try:
        return lazy.verify
    except ModuleNotFoundError as missing:
        if missing.name != "numpy":
            raise
        return lazy.verify_by_states


class TraceVerbs(SessionSettings):
    """The verbs of a session that are about traces; ``checked_kinds`` checks their arguments."""

    def read_traces(self, path: str | Path) -> Iterator[Trace | RulecError]:
        """Read the traces of a file: ``.csv``, ``.parquet``, else JSON Lines; lazily.

        A RulecError takes the place of an invalid trace.
        """
        return lazy.read_traces(path)

    def write_traces(self, traces: Iterable[Trace], path: str | Path) -> None:
        """Write traces in the format given by the file's name. Raises RulecError."""
        listed = list(traces)
        for trace in listed:
            check_trace(trace)
            lazy.check_writable(trace)
        kinds = lazy.kinds_in(state for trace in listed for state in trace.states)
        partial = any(map(lazy.is_partial, listed))
        form = lazy.format_of(str(path))
        with written_whole(Path(path)) as stream:
            lazy.write_traces(iter(listed), stream, str(path), form, kinds, partial=partial)

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
        compiled = self._compiled(rules)
        if not isinstance(drives, Trace):
            return self._judged(drives, compiled, assumptions, wanted, map_path=map_path)
        trace = drives
        if assumptions is not None:
            lazy.check_assumed(assumptions.values, compiled.vocabulary, "values")
            trace = assumptions.applied(trace)
        judged = _trace_judge()(trace, compiled)
        return replace(judged, law=lazy.edition_of(compiled))

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
        if isinstance(drives, lazy.Recording) or lazy.is_recording(str(drives)):
            if assumptions is not None:
                raise ValueError("`assumptions` are for traces; a recording takes `wanted`")
            recording, file = self._recording(drives, map_path)
            return lazy.JudgedDrives(recording, compiled, wanted or lazy.RequestedDrives(), file)
        if wanted is not None or map_path is not None:
            raise ValueError("`wanted` and `map_path` are for recordings; this is a file of traces")
        traces = list(self.read_traces(drives))
        if assumptions is not None:
            lazy.check_assumed(assumptions.values, compiled.vocabulary, "values")
            traces = [assumptions.of([item])[0] for item in traces]
        return lazy.JudgedTraces(traces, compiled, str(drives))

    def verify_many(
        self,
        traces: Iterable[Trace | RulecError],
        rules: Rules,
        assumptions: Assumptions | None = None,
    ) -> Iterator[Verdict | NotJudged]:
        """Judge many traces fast, and yield their verdicts in order.

        A ``NotJudged`` takes the place of a verdict that cannot be given.
        """
        compiled = self._compiled(rules)
        law = lazy.edition_of(compiled)
        if assumptions is not None:
            lazy.check_assumed(assumptions.values, compiled.vocabulary, "values")
            traces = (assumptions.of([item])[0] for item in traces)
        with_law = lazy.with_law
        return (with_law(answer, law) for answer in lazy.verify_many(traces, compiled))

    def verify_columns(self, columns: TraceColumns, rules: Rules) -> list[Verdict | NotJudged]:
        """Judge traces given as arrays, in their order; their ids are their numbers from 0.

        Raises ValueError for an array that fits no name of the vocabulary, or not the layout.
        """
        expected_fields(columns)
        return lazy.verify_columns(columns, self._compiled(rules).fitted_to(columns.step_s))

    def verify_cells(self, cells: TraceCells, rules: Rules) -> list[VerdictColumns]:
        """Judge traces whose states are given as numbers of a few distinct states."""
        return list(lazy.verify_cells(cells, self._compiled(rules).fitted_to(cells.step_s)))

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
        roads = None if map_path is None else Path(map_path)
        return lazy.read_recording(
            lazy.RecordingSource(Path(path), roads, form, scenario_id, frame_rate)
        )

    def formats(self) -> tuple[ListedFormat, ...]:
        """The formats of recorded traffic and of maps, with the signals that each can provide."""
        return lazy.listed_formats(lazy.words_in_order())

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
        read, file = self._recording(recording, map_path)
        compiled = self._compiled(rules)
        request = wanted or lazy.RequestedDrives()
        return lazy.RecordingVerdicts(read, compiled, request, file, says_law=True)

    judge_recording = verify_recording

    def _recording(
        self, given: str | Path | Recording, map_path: str | Path | None
    ) -> tuple[Recording, str]:
        """A recording, read if need be, and what messages call it."""
        if isinstance(given, str | Path):
            return self.read_recording(given, map_path), str(given)
        return given, given.name

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
        return lazy.score.score(candidates, world, self._compiled(rules), after)

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
        words = {"rulebook": str(rulebook), "vocabulary": vocabulary}
        query = lazy.read_query(formula, **words, search_path=self.search_path, at=self.at)
        request = wanted or lazy.RequestedDrives()
        if isinstance(drives, lazy.Recording):
            return lazy.in_recordings([drives], query, request, drives.name)
        assumed = lazy.Assumptions(None, request.assumed, request.defaults)
        lazy.check_assumed(request.assumed, query.vocabulary)
        if not isinstance(drives, str | Path):
            return lazy.in_traces(drives, query, assumed, "")
        if not lazy.is_recording(str(drives)):
            return lazy.in_traces(self.read_traces(drives), query, assumed, str(drives))
        roads = None if map_path is None else Path(map_path)
        recordings = lazy.read_recordings(lazy.RecordingSource(Path(drives), roads))
        return lazy.in_recordings(recordings, query, request, str(drives))

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
        by = (by,) if isinstance(by, str) else by
        known = get_args(lazy.GroupKey)
        if unknown := [name for name in by if name not in known]:
            raise ValueError(f"drives are grouped by {', '.join(known)}, not by {unknown[0]!r}")
        if not 0 < confidence < 1:
            raise ValueError(f"`confidence` is between 0 and 1, such as 0.95, not {confidence}")
        paths = [findings] if isinstance(findings, str | Path) else findings
        return lazy.rates_of_findings(
            [*map(str, paths)], by, confidence=float(confidence), seed=seed
        )

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
        finite("at_s", at_s)
        vehicle, part, _ = ego.partition("#")
        request = replace(wanted or lazy.RequestedDrives(), egos=(vehicle,) if vehicle else ())
        verdicts = self.verify_recording(recording, rules, request, map_path)
        known = {rule.name for rule in verdicts.rules.rules}
        if unknown := [name for name in only if name not in known]:
            raise ValueError(f"`only` has {unknown[0]!r}: {verdicts.rules.name} has no such rule")
        trace = ego if part else ""
        drawing = lazy.drive_drawing(verdicts, trace, frozenset(only) if only else None, at_s)
        return lazy.picture_formats.as_bytes(drawing, form, verdicts.recording.name, theme)
