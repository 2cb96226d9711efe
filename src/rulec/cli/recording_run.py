"""Files of recorded traffic, judged one after the other or in parallel."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from rulec.batch.jobs import Jobs
from rulec.batch.recording_judge import (
    DriveProblem,
    JudgedRecording,
    JudgeSettings,
    in_short,
    judged_files,
)
from rulec.cli import lazy_imports as lazy
from rulec.cli.options.standard_input import copied
from rulec.cli.output import print_lost
from rulec.cli.verdict_run import VerdictRun
from rulec.diagnostics import RulecError
from rulec.recordings.recording_inputs import STANDARD_INPUT
from rulec.report.text.console import page_width, progress
from rulec.report.verdicts.batch_table import as_text


@dataclass(kw_only=True)
class RecordingRun(VerdictRun):
    """Judges files of recorded traffic, and sums up the results."""

    settings: JudgeSettings
    unread: list[str] = field(default_factory=list)

    def files(self, paths: Sequence[str], jobs: Jobs) -> None:
        """Judge files, with one table for all of them if there are several."""
        # Modules and rules are permanent, so later garbage collections need not visit them.
        gc.freeze()
        several = len(paths) > 1
        with _without_standard_input(paths) as (files, labels):
            self.settings = replace(self.settings, labels=labels)
            task = f"{len(files):,} files" if several else labels.get(files[0], files[0])
            with progress(f"judging {task}", len(files)) as tell:
                for file, piece in judged_files(self.settings, files, jobs, tell, self._lost):
                    if isinstance(piece, str):
                        self.to.line(piece)
                    elif isinstance(piece, DriveProblem):
                        self.complete = False
                        self.complaints.add(piece.error)
                    elif isinstance(piece, JudgedRecording):
                        self._sum_up(piece, several=several)
                    else:
                        self.not_read(piece, labels.get(file, file))
        if several or self.total.judged_recordings > 1:
            self.to.text(f"\n{as_text(self.total, self.rules, self.unread, page_width())}")

    def not_read(self, error: RulecError, file: str = "") -> None:
        """Record that a file, by default the one that the error is about, could not be read."""
        self.complete = False
        self.complaints.add(error)
        place = error.diagnostics[0].place
        file = file or (place.file if place is not None else "")
        if file not in self.unread:
            self.unread.append(file)
            if self.to.writers:
                recording = lazy.not_judged_file(file, error, self.rules.name)
                if self.to.to_rows is not None:
                    row = self.to.to_rows.of_nothing({"file": file}, recording.failure)
                    recording = replace(recording, rows=(row,))
                self.to.add(recording)

    def _lost(self, file: str, signal_number: int | None) -> None:
        print_lost("judged", self.settings.labels.get(file, file), signal_number)

    def _sum_up(self, judged: JudgedRecording, *, several: bool) -> None:
        self.total.add(judged.file, judged.tally)
        self.judged |= bool(judged.tally.judged_in) or not self.rules.rules
        self.complete &= bool(judged.tally.judged)
        self.open_hard |= bool(judged.tally.open_hard)
        if self.to.texts:
            is_short = several and self.settings.opportunities is None
            first = in_short(judged, page_width()) if is_short else judged.answer
            self.to.text("\n".join([first, *judged.explained]))
        if judged.findings is not None:
            self.to.add(judged.findings)


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
