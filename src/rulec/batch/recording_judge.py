"""Judge files of recorded traffic, in one process or several, and give results piece by piece."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.batch.batch_messages import process_lost
from rulec.batch.jobs import ALONE, Jobs, LostTask
from rulec.batch.worker_pool import in_order, nobody
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.diagnostic import with_place
from rulec.diagnostics.fault_messages import contained
from rulec.extraction.recording_parts import RecordingPart
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.lost_drives import lost_drive
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.moments.opportunity_outcomes import Opportunity
from rulec.monitoring.verdict import NotJudged
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from rulec.report.text.terminal_text import broken, visible
from rulec.report.verdicts.recording_answer import (
    MOST_SHOWN,
    AnswerLayout,
    RecordingAnswer,
    summary,
)
from rulec.report.verdicts.violation_tally import ViolationTally
from rulec.resource_limits import BudgetSpentError

if TYPE_CHECKING:
    from rulec.batch.drive_accounts import DriveAccounts
    from rulec.monitoring.explain.explanation import Explanation
    from rulec.report.findings.findings_of_drives import GatheredFindings
    from rulec.report.findings.verdict_finding import RecordingFindings, VerdictFinding

RowMaker: TypeAlias = Callable[
    [DriveVerdict | NoDrive, RecordingVerdicts, str, "Sequence[VerdictFinding] | None"],
    Iterator[Mapping[str, object]],
]
"""Makes the table rows of a drive and its findings; it is sent to other processes."""


@dataclass(frozen=True, slots=True)
class JudgeSettings:
    """How files are judged, and which results are wanted.

    ``source`` says how to read each file; its path is replaced. The first ``to_explain`` violations
    of each file are explained, part by part if ``every_part``. The results may be text in this
    ``layout``, lines of JSON (by ``to_line``, as in ``recording_json``) and ``findings``. Files
    whose paths mean nothing to a reader have names in ``labels``. ``to_rows``, if given, makes the
    rows of drives and rules for tables of findings, ``opportunities`` finds those of a drive.
    """

    rules: CompiledRulebook
    request: RequestedDrives
    source: RecordingSource
    to_explain: int
    every_part: bool
    layout: AnswerLayout | None
    findings: bool
    to_line: Callable[..., str] | None = None
    labels: Mapping[str, str] = field(default_factory=dict)
    to_rows: RowMaker | None = None
    opportunities: Callable[..., Sequence[Opportunity]] | None = None


@dataclass(frozen=True, slots=True)
class JudgedRecording:
    """A judged recording: its counts, the answer as text, and its findings, if wanted.

    ``explained`` are the blocks of text that explain its first violations.
    """

    file: str
    name: str
    tally: ViolationTally
    answer: str
    explained: tuple[str, ...]
    findings: RecordingFindings | None


@dataclass(frozen=True, slots=True)
class DriveProblem:
    """Why one drive could not be judged, while the rest of its recording could."""

    error: RulecError


Piece = str | RulecError | DriveProblem | JudgedRecording
"""A line of JSON, the error of a file or of a drive, or the result of a whole recording."""

LARGE_BYTES = 1_000_000
"""Judging files of this total size (bytes) takes long enough to start processes at once."""


def judged_files(
    settings: JudgeSettings,
    files: Sequence[str],
    jobs: Jobs,
    tell: Callable[[float], object],
    lost: Callable[[str, int | None], object],
) -> Iterator[tuple[str, Piece]]:
    """Each file with each piece of its result, in the files' order.

    ``tell`` is called with the number of finished files; ``lost`` with a file whose process was
    killed, and the signal, before the file, or its part, is judged again.
    """
    if len(files) == 1:
        (file,) = files
        for piece in judged_file(
            settings, file, lambda done, every: tell(done / every), jobs, partial(lost, file)
        ):
            yield file, piece
        return
    if _size(files) >= LARGE_BYTES:
        jobs = replace(jobs, alone_s=0.0)
    for file, result in in_order(partial(judged_file, settings), files, jobs, tell, lost):
        if isinstance(result, LostTask):
            yield file, process_lost(settings.labels.get(file, file), result.signal_number)
        else:
            yield file, result


def _size(files: Sequence[str]) -> int:
    """The total size of the first thousand files in bytes, which is enough for an estimate."""
    return sum(path.stat().st_size for path in map(Path, files[:1000]) if path.is_file())


def judged_file(
    settings: JudgeSettings,
    path: str,
    tell: Callable[[int, int], object] = nobody,
    jobs: Jobs = ALONE,
    lost: Callable[[int | None], object] = nobody,
) -> Iterator[Piece]:
    """The results of a file in order; if the file cannot be read, the error.

    ``tell`` gets the numbers of finished and of all vehicles (or parts). The parts of a long
    recording are judged in several processes; ``lost`` is called with the signal that killed one
    of them, before its part is judged again.
    """
    left = settings.to_explain
    label = settings.labels.get(path, path)
    try:
        with contained("not judged", SourceLocation(path)):
            for recording in read_recordings(replace(settings.source, path=Path(path))):
                judged = _RecordingJudge(settings, recording, label, left)
                if jobs.processes > 1 and len(judged.parts) > 1:
                    yield from judged.pieces_side_by_side(tell, jobs, lost)
                else:
                    yield from judged.pieces(tell)
                left = judged.left
    except BudgetSpentError:
        raise
    except RulecError as error:
        yield error if label == path else _relabelled(error, path, label)


def _relabelled(error: RulecError, path: str, label: str) -> RulecError:
    """An error with the file's path in its places replaced by a label."""
    return RulecError(
        [
            replace(diagnostic, place=replace(diagnostic.place, file=label))
            if diagnostic.place is not None and diagnostic.place.file == path
            else diagnostic
            for diagnostic in error.diagnostics
        ]
    )


@dataclass(slots=True)
class _JudgedDrives:
    """The results of some drives, each by itself and all together.

    ``pieces`` are the results of single drives, ``shown`` the first findings of each violated rule.
    """

    tally: ViolationTally = field(default_factory=ViolationTally)
    blocks: list[str] = field(default_factory=list)
    rows: list[Mapping[str, object]] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)
    findings: GatheredFindings | None = None
    shown: dict[str, list[VerdictFinding]] = field(default_factory=dict)
    n_explained: int = 0


class _RecordingJudge:
    """Judges one recording and explains up to ``left`` violations."""

    def __init__(self, settings: JudgeSettings, recording: Recording, file: str, left: int) -> None:
        self._settings = settings
        self._file = file
        self._verdicts = RecordingVerdicts(recording, settings.rules, settings.request, file)
        self._judged = _JudgedDrives()
        self.left = left

    @cached_property
    def _accounts(self) -> DriveAccounts:
        # Explanations and evidence, 40 ms: only where something is violated or findings are wanted.
        from rulec.batch.drive_accounts import DriveAccounts

        return DriveAccounts(self._verdicts, self._file)

    @property
    def parts(self) -> Sequence[RecordingPart]:
        """The parts into which the recording is divided."""
        return self._verdicts.drives.parts

    def pieces(self, tell: Callable[[int, int], object]) -> Iterator[Piece]:
        """A piece for each drive that has something to report, then the recording."""
        # No name for a verdict here: it would keep the arrays of its drive alive until the next
        # one.
        for number, pieces in enumerate(map(self._reported, self._verdicts.answers()), 1):
            tell(number, len(self._verdicts.egos))
            yield from pieces
        yield self._whole()

    def pieces_side_by_side(
        self,
        tell: Callable[[int, int], object],
        jobs: Jobs,
        lost: Callable[[int | None], object],
    ) -> Iterator[Piece]:
        """Like ``pieces``, with the parts of the recording judged in several processes.

        Raises RulecError R0708 if the process of a part is killed twice.
        """
        parts, settings, file = self.parts, self._settings, self._file
        shared = replace(parts[0].recording, participants=())
        work = partial(_judged_part, settings, shared, file, 0)
        tasks = [(part.egos, part.recording.participants) for part in parts]
        for task, judged in in_order(
            work,
            tasks,
            # Parts take more than a moment, and this process would have to keep all of them
            replace(jobs, alone_s=0.0),
            lambda done: tell(done, len(tasks)),
            lambda _, signal_number: lost(signal_number),
        ):
            if isinstance(judged, LostTask):
                raise process_lost(file, judged.signal_number)
            if self.left and judged.tally.first_s:
                # Only this process knows which violations are the first ones
                (judged,) = _judged_part(settings, shared, file, self.left, task)
                self.left -= judged.n_explained
            yield from judged.pieces
            self._take(judged)
        yield self._whole()

    def judged_drives(self) -> _JudgedDrives:
        """The results of all drives."""
        judged = self._judged
        for answer in self._verdicts.answers():
            judged.pieces += self._reported(answer)
        judged.findings = self._accounts.findings.gathered if self._settings.findings else None
        return judged

    def _take(self, later: _JudgedDrives) -> None:
        self._judged.tally.include(later.tally)
        self._judged.blocks += later.blocks
        self._judged.rows += later.rows
        for rule, findings in later.shown.items():
            own = self._judged.shown.setdefault(rule, [])
            own += findings[: MOST_SHOWN - len(own)]
        if later.findings is not None:
            self._accounts.findings.gathered.include(later.findings)

    def _reported(self, answer: DriveVerdict | NoDrive) -> list[Piece]:
        """What is to be said of a drive; the rest is kept for the whole recording."""
        settings, verdicts, judged = self._settings, self._verdicts, self._judged
        try:
            pieces: list[Piece] = []
            explained: list[Explanation] = []
            faults: Sequence[RulecError] = ()
            if isinstance(answer, NoDrive):
                faults = [] if answer.fault is None else [answer.fault]
            elif isinstance(answer.answer, NotJudged):
                pieces.append(DriveProblem(answer.answer.error))
            else:
                faults, explained = answer.answer.faults, self._explained(answer)
            place = SourceLocation(self._file)
            pieces += [DriveProblem(with_place(fault, place)) for fault in faults]
            own = self._accounts.findings.add(answer, explained) if settings.findings else None
            met: Sequence[Opportunity] | None = None
            if settings.opportunities is not None and not isinstance(answer, NoDrive):
                met = settings.opportunities(answer.drive.arrays, verdicts.rules, answer.answer)
            if settings.layout is not None:
                self._show(answer, explained, own)
            if settings.to_rows is not None:
                judged.rows += settings.to_rows(answer, verdicts, self._file, own)
            if settings.to_line is not None:
                pieces.append(settings.to_line(answer, verdicts, explained, met))
            names = [rule.name for rule in verdicts.rules.rules]
            counts = None if met is None else Counter([own.rule for own in met])
            judged.tally.add(answer, names, counts)
            return pieces
        except Exception as problem:
            if isinstance(answer, NoDrive):
                raise
            return self._reported(lost_drive(answer.drive.arrays.id, problem))

    def _show(
        self,
        answer: DriveVerdict | NoDrive,
        explained: Sequence[Explanation],
        findings: Sequence[VerdictFinding] | None,
    ) -> None:
        """Keep the first findings of each violated rule; ``findings`` are the drive's, if made."""
        if isinstance(answer, NoDrive) or isinstance(answer.answer, NotJudged):
            return
        for number, violation in enumerate(answer.answer.violations):
            shown = self._judged.shown.setdefault(violation.rule, [])
            if len(shown) < MOST_SHOWN:
                if findings is None:
                    explanation = explained[number] if number < len(explained) else None
                    shown.append(self._accounts.finding(violation, answer.drive, explanation))
                else:
                    shown.append(findings[number])

    def _whole(self) -> JudgedRecording:
        verdicts, judged = self._verdicts, self._judged
        text = ""
        if self._settings.layout is not None:
            answer = RecordingAnswer(verdicts, judged.tally, judged.shown, self._settings.layout)
            text = answer.as_text()
        findings = None
        if self._settings.findings:
            findings = replace(self._accounts.findings.whole(), rows=tuple(judged.rows))
        return JudgedRecording(
            self._file,
            verdicts.recording.name,
            judged.tally,
            text,
            explained=tuple(judged.blocks),
            findings=findings,
        )

    def _explained(self, result: DriveVerdict) -> list[Explanation]:
        """Explanations of a drive's first violations; their text is shown with the recording."""
        verdict, drive = result.answer, result.drive
        assert not isinstance(verdict, NotJudged), "it has been judged"
        chosen = verdict.violations[: self.left]
        if not chosen:
            return []
        self.left -= len(chosen)
        self._judged.n_explained += len(chosen)
        explained = self._accounts.explained(chosen, drive)
        if self._settings.layout is not None:
            width, every_part = self._settings.layout.width, self._settings.every_part
            details = self._accounts.details(result, explained, width=width, every_part=every_part)
            self._judged.blocks.append(f"\n{details}")
        return explained


def _judged_part(
    settings: JudgeSettings,
    shared: Recording,
    file: str,
    left: int,
    part: tuple[tuple[str, ...], tuple[Participant, ...]],
) -> Iterator[_JudgedDrives]:
    """Judge one part of a recording: its egos and participants; all else comes from ``shared``."""
    egos, participants = part
    settings = replace(settings, request=replace(settings.request, egos=egos))
    recording = replace(shared, participants=participants)
    yield _RecordingJudge(settings, recording, file, left).judged_drives()


def in_short(judged: JudgedRecording, width: int) -> str:
    """One of many recordings: drives by outcome, and per violated rule."""
    where = f"{judged.file}: {judged.name}" if judged.name not in judged.file else judged.file
    counts = summary(judged.tally)
    violated = ", ".join(f"{rule} {len(drives)}" for rule, drives in judged.tally.first_s.items())
    text = visible(f"{where}: {counts}" + (f" ({violated})" if violated else ""))
    return "\n".join(broken(text, width, later="  "))
