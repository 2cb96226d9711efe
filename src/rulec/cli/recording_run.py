"""Files of recorded traffic, judged one after the other or in parallel."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial

from rulec.batch.jobs import Jobs
from rulec.batch.recording_judge import (
    DriveProblem,
    JudgedRecording,
    JudgeSettings,
    Piece,
    in_short,
    judge_with_progress,
)
from rulec.cli import lazy_imports as lazy
from rulec.cli.options.standard_input import copied
from rulec.cli.output import print_lost
from rulec.cli.verdict_outputs import VerdictOutputs
from rulec.diagnostics import RulecError
from rulec.recordings.recording_inputs import STANDARD_INPUT
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import page_width, progress
from rulec.report.verdicts.batch_table import BatchTally, as_text


@dataclass
class RecordingRun:
    """Judges files of recorded traffic, and sums up the results."""

    settings: JudgeSettings
    to: VerdictOutputs
    complaints: Complaints
    total: BatchTally = field(default_factory=BatchTally)
    unread: list[str] = field(default_factory=list)
    judged: bool = False
    complete: bool = True
    open_hard: bool = False

    def files(self, paths: Sequence[str], jobs: Jobs) -> None:
        """Judge files, with one table for all of them if there are several."""
        # Modules and rules are permanent, so later garbage collections need not visit them.
        gc.freeze()
        with _without_standard_input(paths) as (files, labels):
            self.settings = replace(self.settings, labels=labels)
            several = len(files) > 1
            for file, piece in self._aloud(files, jobs):
                self._take(labels.get(file, file), piece, several=several)
        if several or self.total.judged_recordings > 1:
            self.to.text(f"\n{as_text(self.total, self.settings.rules, self.unread, page_width())}")

    def not_read(self, error: RulecError, file: str = "") -> None:
        """Record that a file, by default the one that the error is about, could not be read."""
        self.complete = False
        self.complaints.add(error)
        place = error.diagnostics[0].place
        file = file or (place.file if place is not None else "")
        if file not in self.unread:
            self.unread.append(file)
            if self.to.wants_findings:
                recording = lazy.not_judged_file(file, error, self.settings.rules.name)
                if self.to.to_rows is not None:
                    row = self.to.to_rows.of_nothing({"file": file}, recording.failure)
                    recording = replace(recording, rows=(row,))
                self.to.add(recording)

    def _aloud(self, files: Sequence[str], jobs: Jobs) -> Iterator[tuple[str, Piece]]:
        """The pieces of all files, with progress messages."""
        if len(files) > 1:
            with progress(f"judging {len(files):,} files", len(files)) as tell:
                yield from lazy.judged_files(self.settings, files, jobs, tell, self._lost)
            return
        (file,) = files
        with progress(f"judging {self.settings.labels.get(file, file)}", 1) as tell:
            pieces = judge_with_progress(
                self.settings,
                file,
                lambda done, all_: tell(done / all_),
                jobs,
                partial(self._lost, file),
            )
            for piece in pieces:
                yield file, piece

    def _lost(self, file: str, signal_number: int | None) -> None:
        print_lost("judged", self.settings.labels.get(file, file), signal_number)

    def _take(self, file: str, piece: Piece, *, several: bool) -> None:
        if isinstance(piece, str):
            self.to.line(piece)
        elif isinstance(piece, DriveProblem):
            self.complete = False
            self.complaints.add(piece.error)
        elif isinstance(piece, JudgedRecording):
            self.total.add(piece.file, piece.tally)
            self.judged |= bool(piece.tally.judged_in) or not self.settings.rules.rules
            self.complete &= bool(piece.tally.judged)
            self.open_hard |= bool(piece.tally.open_hard)
            if self.to.wants_text:
                is_short = several and self.settings.idle_rules is None
                first = in_short(piece, page_width()) if is_short else piece.answer
                self.to.text("\n".join([first, *piece.explained]))
            if piece.findings is not None:
                self.to.add(piece.findings)
        else:
            self.not_read(piece, file)


@contextmanager
def _without_standard_input(
    paths: Sequence[str],
) -> Iterator[tuple[list[str], dict[str, str]]]:
    """The files, with standard input copied to one, and the names to show for copies."""
    if STANDARD_INPUT not in paths:
        yield list(paths), {}
        return
    with copied() as copy:
        names = [str(copy) if path == STANDARD_INPUT else path for path in paths]
        yield names, {str(copy): copy.name}
