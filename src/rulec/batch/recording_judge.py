"""A file of recorded traffic, judged: what there is to be shown of it, piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts, ViolationTally
from rulec.extraction.selection import RequestedDrives
from rulec.monitoring.verdict import NotJudged
from rulec.recordings.recording import Recording
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from rulec.report.text.terminal_text import visible
from rulec.report.verdicts import recording_table, verdict_report

if TYPE_CHECKING:
    from rulec.monitoring.explain.explanation import Explanation
    from rulec.report.verdict_findings.found_in_drives import DriveFindings
    from rulec.report.verdict_findings.verdict_finding import FoundInRecording, VerdictFinding

RowMaker: TypeAlias = Callable[
    [DriveVerdict | NoDrive, RecordingVerdicts, str, "Sequence[VerdictFinding] | None"],
    Iterator[Mapping[str, object]],
]
"""What makes rows of a drive of a file, and of what was found of it; it is sent to processes."""


@dataclass(frozen=True, slots=True)
class JudgeSettings:
    """How files are judged, and what is wanted of the answer.

    ``source`` says how to read each of them; its path is another one. The first ``to_explain``
    violations of each file are explained, by ``every_part`` if wanted, in ``width`` columns. Wanted
    may be ``text``, ``lines`` (of JSON, one for each drive) and ``findings``. ``labels`` are what
    files are called whose paths would say nothing to anybody. ``to_rows`` makes of each drive the
    rows that tables of findings have, if they are to have those of drives and rules, too.
    """

    rules: CompiledRulebook
    request: RequestedDrives
    source: RecordingSource
    to_explain: int
    every_part: bool
    width: int
    text: bool
    lines: bool
    findings: bool
    labels: Mapping[str, str] = field(default_factory=dict)
    to_rows: RowMaker | None = None


@dataclass(frozen=True, slots=True)
class JudgedRecording:
    """A recording that has been judged: its numbers, as text, and its findings, if wanted.

    ``explained`` are the blocks of text that explain its first violations.
    """

    file: str
    name: str
    tally: ViolationTally
    table: str
    explained: tuple[str, ...]
    found: FoundInRecording | None


@dataclass(frozen=True, slots=True)
class DriveProblem:
    """Why a drive could not be judged; the others of its recording could."""

    error: RulecError


Piece = str | RulecError | DriveProblem | JudgedRecording
"""A line of JSON, what is wrong with a file or with a drive, or a whole recording."""


def judge(settings: JudgeSettings, path: str) -> Iterator[Piece]:
    """The pieces of a file, in its order; one that cannot be read is an error."""
    return judge_aloud(settings, path, _silently)


def judge_aloud(
    settings: JudgeSettings, path: str, tell: Callable[[int, int], object]
) -> Iterator[Piece]:
    """As ``judge``; it tells how many vehicles of how many are done."""
    left = settings.to_explain
    label = settings.labels.get(path, path)
    try:
        for recording in read_recordings(replace(settings.source, path=Path(path))):
            judged = _RecordingJudge(settings, recording, label, left)
            yield from judged.pieces(tell)
            left = judged.left
    except RulecError as error:
        yield error if label == path else _relabelled(error, path, label)


def _relabelled(error: RulecError, path: str, label: str) -> RulecError:
    """An error whose place is called otherwise."""
    return RulecError(
        [
            replace(one, place=replace(one.place, file=label))
            if one.place is not None and one.place.file == path
            else one
            for one in error.diagnostics
        ]
    )


def _silently(done: int, total: int) -> None:
    """Tell nobody."""


class _RecordingJudge:
    """The judge of one recording, which explains as many violations as are ``left``."""

    def __init__(self, settings: JudgeSettings, recording: Recording, file: str, left: int) -> None:
        self._settings = settings
        self._file = file
        self._verdicts = RecordingVerdicts(recording, settings.rules, settings.request, file)
        self._tally = ViolationTally()
        self._blocks: list[str] = []
        self._findings = _findings(self._verdicts, file) if settings.findings else None
        self.left = left

    def pieces(self, tell: Callable[[int, int], object]) -> Iterator[Piece]:
        """A piece for each drive that has something to say, and the recording."""
        verdicts, tally = self._verdicts, self._tally
        names = [rule.name for rule in verdicts.rules.rules]
        rows: list[Mapping[str, object]] = []
        for number, answer in enumerate(verdicts.answers(), 1):
            tell(number, len(verdicts.egos))
            tally.add(answer, names)
            explained: list[Explanation] = []
            if isinstance(answer, DriveVerdict):
                if isinstance(answer.answer, NotJudged):
                    yield DriveProblem(answer.answer.error)
                else:
                    explained = self._explained(answer)
            own = None if self._findings is None else self._findings.add(answer, explained)
            if self._settings.to_rows is not None:
                rows += self._settings.to_rows(answer, verdicts, self._file, own)
            if self._settings.lines:
                # JSON of explanations and evidence, 30 ms: only where it is wanted.
                from rulec.report.verdicts import recording_json

                yield recording_json.as_json(answer, verdicts, explained)
        table = recording_table.as_text(verdicts, tally) if self._settings.text else ""
        found = None
        if self._findings is not None:
            found = replace(self._findings.whole(), rows=tuple(rows))
        name = verdicts.recording.name
        explained_in_text = tuple(self._blocks)
        yield JudgedRecording(
            self._file, name, tally, table, explained=explained_in_text, found=found
        )

    def _explained(self, result: DriveVerdict) -> list[Explanation]:
        """The first violations of a drive explained; they are shown with the recording."""
        verdict, drive, rules = result.answer, result.drive, self._verdicts.rules
        assert not isinstance(verdict, NotJudged), "it has been judged"
        chosen = verdict.violations[: self.left]
        if not chosen:
            return []
        # Explanations, 20 ms: only where something is violated.
        from rulec.monitoring.explain.explanation import explain

        self.left -= len(chosen)
        explained = [
            explain(violation, drive.trace, rules, drive.decided_by) for violation in chosen
        ]
        if self._settings.text:
            details = verdict_report.as_text(
                verdict,
                rules,
                explained,
                every_part=self._settings.every_part,
                width=self._settings.width,
                doubts=False,
            )
            self._blocks.append(f"\n{details}")
        return explained


def _findings(verdicts: RecordingVerdicts, file: str) -> DriveFindings:
    # Evidence and its findings, 20 ms: only where they are wanted.
    from rulec.report.verdict_findings.found_in_drives import DriveFindings

    return DriveFindings(verdicts, file)


def in_a_line(judged: JudgedRecording) -> str:
    """A recording of many: how its drives came out, and what was violated how often."""
    where = f"{judged.file}: {judged.name}" if judged.name not in judged.file else judged.file
    counts = recording_table.summary(judged.tally)
    violated = ", ".join(f"{rule} {len(who)}" for rule, who in judged.tally.first_s.items())
    return visible(f"{where}: {counts}" + (f" ({violated})" if violated else ""))
