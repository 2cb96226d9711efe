"""``rulec verify``: traces and recorded traffic judged by a rulebook."""

from __future__ import annotations

import os
import stat
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import IO, TYPE_CHECKING, Any, cast

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import scenario_options
from rulec.cli.options import shared_options as shared
from rulec.cli.output import read_machines
from rulec.diagnostics import RulecError
from rulec.files import opened
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import page_width, print_result, progress

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.extraction.selection import RequestedDrives
    from rulec.monitoring.assumptions import Assumptions
    from rulec.monitoring.explain.explanation import Deciding, Explanation
    from rulec.monitoring.verdict import NotJudged, Verdict
    from rulec.recordings.recording import Recording
    from rulec.recordings.recording_format import RecordingSource
    from rulec.trace import Trace
    from rulec.trace.formats.trace_files import Format
    from rulec.trace.trace_model import Ending

    Answer = tuple[Sequence[Trace | RulecError], int, Verdict | NotJudged]


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@shared.rulebook_option()
@shared.number_option(
    "--explain",
    "n_explained",
    "Explain the first N violations state by state.  [default: 1; with --json 0]",
)
@click.option(
    "--every-part",
    is_flag=True,
    help="Explain by every part of a formula and every state, however large the table becomes.",
)
@click.option(
    "--strict",
    is_flag=True,
    help="Count hard rules that are open, for want of values or of an end, as violated.",
)
@shared.table_format_option("traces")
@click.option(
    "--end",
    "ends",
    type=click.Choice(["cut", "complete"]),
    help="Of traces: cut out of something longer, or over at their end.  [default: as the file "
    "says, else complete]",
)
@click.option(
    "--ego",
    "egos",
    multiple=True,
    metavar="ID",
    help="In recorded traffic: only this vehicle's drive.  [default: everybody's]",
)
@scenario_options.drives_options
@scenario_options.recording_options
@shared.json_option
@shared.at_option
def command(
    files: tuple[str, ...],
    rulebook: str,
    n_explained: int | None,
    every_part: bool,
    strict: bool,
    form: Format | None,
    ends: Ending | None,
    json_output: bool,
    at: str,
    egos: tuple[str, ...],
    **options: Any,
) -> int:
    """Judge the traces in FILE..., as JSON Lines, CSV or Parquet; `-` is standard input.

    Prints the violations of every trace and a summary; with --json one line per trace. A trace that
    cannot be judged is reported and does not stop the others.

    FILE may also be recorded traffic, of any format that `rulec formats` lists. Then every vehicle
    is judged by what it did, and a table says who violated what.

    Exit status: 0 no hard rule is violated, 1 one is, 2 a trace could not be judged, or no rule.
    """
    # Formats of recordings, 80 ms: not for --help.
    from rulec.recordings.recording_files import is_recording

    rules = read_machines(rulebook, at)
    named = options["input_format"] is not None
    recordings = [file for file in files if named or is_recording(file)]
    about = {name: value for name, value in options.items() if name != "assumed"}
    option = scenario_options.given_drives_option({"egos": egos, **about})
    if option and not recordings:
        raise click.UsageError(f"{option} is for recorded traffic, and there is none.")
    to_explain = n_explained if n_explained is not None else 0 if json_output else 1
    run = _Run(rules, json_output, Complaints(), to_explain, every_part=every_part, strict=strict)
    if ends is not None and recordings:
        raise click.UsageError("--end is for traces; a recording is always cut.")
    if recordings:
        request = scenario_options.requested_drives(egos, options, rules.vocabulary)
        for file in recordings:
            run.recordings(scenario_options.recording_source(file, dict(options)), request)
    if len(recordings) < len(files):
        assumed = scenario_options.assumptions(ends, options["assumed"], rules.vocabulary)
        run.traces([file for file in files if file not in recordings], form, assumed)
    run.complaints.close()
    return ExitStatus.after(answered=run.judged and not run.not_answered, failed=run.violated)


@dataclass
class _Run:
    """Settings for every file, and the results so far."""

    rules: CompiledRulebook
    json_output: bool
    complaints: Complaints
    to_explain: int
    every_part: bool
    strict: bool
    violated: bool = False
    judged: bool = False
    not_answered: bool = False

    def traces(self, files: Sequence[str], form: Format | None, assumed: Assumptions) -> None:
        """Judge the traces of files, with one summary for all of them."""
        # Tables of automata and verdicts, 230 ms: not for --help, and not for recordings alone.
        from rulec.monitoring.batch.batch_verify import rulebook_for
        from rulec.monitoring.verdict import NotJudged
        from rulec.report.verdicts import verdict_json, verdict_report

        counts: Counter[bool | None] = Counter()
        not_judged = 0
        for traces, place, answer in _answers(files, form, self.rules, assumed):
            if isinstance(answer, NotJudged):
                not_judged += 1
                self._complain(answer.error)
                if self.json_output:
                    print_result(verdict_json.not_judged_as_json(answer))
                continue
            counts[answer.satisfied] += 1
            self.violated |= self.strict and any(x.strength == "hard" for x in answer.open)
            self.judged |= len(answer.not_judged) < max(len(self.rules.rules), 1)
            if answer.violations or answer.open or answer.not_judged or self.json_output:
                used = rulebook_for(traces, place, self.rules)
                # A trace of a table is made only if it is looked at.
                explained = self._explained(answer, traces[place], used) if self.to_explain else []
                print_result(
                    verdict_json.as_json(answer, used, explained)
                    if self.json_output
                    else verdict_report.as_text(
                        answer, used, explained, every_part=self.every_part, width=page_width()
                    )
                )
        if not self.json_output:
            print_result(verdict_report.summary(counts, not_judged))
        self.violated |= counts[False] > 0

    def recordings(self, source: RecordingSource, request: RequestedDrives) -> None:
        """Judge every recording in a file."""
        # numpy and shapely, 250 ms: only for recordings.
        from rulec.recordings.recording_files import read_recordings

        try:
            for recording in read_recordings(source):
                self._recording(recording, str(source.path), request)
        except RulecError as error:
            self._complain(error)

    def _recording(self, recording: Recording, file: str, request: RequestedDrives) -> None:
        """Judge every drive of a recording. Raises RulecError."""
        # numpy and shapely, 250 ms: as for ``recordings``.
        from rulec.extraction import recording_verdicts as recorded
        from rulec.monitoring.verdict import NotJudged
        from rulec.report.verdicts import recording_table, verdict_report

        drives = recorded.RecordingVerdicts(recording, self.rules, request, file)
        tally, blocks = recorded.ViolationTally(), []
        names = [rule.name for rule in self.rules.rules]
        with progress(f"judging {file}", len(drives.egos)) as tell:
            for number, answer in enumerate(drives.answers(), 1):
                tell(number)
                tally.add(answer, names)
                explained: list[Explanation] = []
                if isinstance(answer, recorded.DriveVerdict):
                    verdict = answer.answer
                    if isinstance(verdict, NotJudged):
                        self._complain(verdict.error)
                    elif explained := self._explained(
                        verdict, answer.drive.trace, drives.rules, answer.drive.decided_by
                    ):
                        details = verdict_report.as_text(
                            verdict,
                            drives.rules,
                            explained,
                            every_part=self.every_part,
                            width=page_width(),
                            doubts=False,
                        )
                        blocks.append(f"\n{details}")
                if self.json_output:
                    print_result(recording_table.as_json(answer, drives, explained))
        if not self.json_output:
            table, summary = recording_table.as_text(drives, tally), recording_table.summary(tally)
            print_result("\n".join([table, *blocks, summary]))
        self.violated |= bool(tally.violated) or (self.strict and bool(tally.open_hard))
        self.judged |= bool(tally.judged_in) or not names
        self.not_answered |= not tally.judged

    def _explained(
        self,
        verdict: Verdict,
        trace: Trace | RulecError,
        rules: CompiledRulebook,
        decided_by: Mapping[str, Deciding] = MappingProxyType({}),
    ) -> list[Explanation]:
        """The first violations explained, as many as are still to be."""
        # Tables of automata, as for ``traces``.
        from rulec.monitoring.explain.explanation import explain

        chosen = verdict.violations[: self.to_explain]
        self.to_explain -= len(chosen)
        given = cast("Trace", trace)
        return [explain(violation, given, rules, decided_by) for violation in chosen]

    def _complain(self, error: RulecError) -> None:
        self.complaints.add(error)
        self.not_answered = True


def _answers(
    files: Sequence[str], form: Format | None, rules: CompiledRulebook, assumed: Assumptions
) -> Iterator[Answer]:
    """Traces, which of them, and its verdict, or why there is none."""
    # Tables of automata, 160 ms: as for ``_Run.traces``.
    from rulec.monitoring.batch.batch_verify import verify_items
    from rulec.monitoring.verdict import NotJudged
    from rulec.trace.formats.trace_files import format_of, read_chunks

    def answers_in(
        stream: IO[bytes], name: str, form: Format, size: int | None
    ) -> Iterator[Answer]:
        with progress(f"judging {name}", size) as tell:
            for chunk in read_chunks(stream, name, form):
                traces, answers = verify_items(assumed.of(chunk), rules)
                for place, answer in enumerate(answers):
                    yield traces, place, answer
                if size is not None:
                    tell(stream.tell())

    for file in files:
        try:
            if file == "-":
                yield from answers_in(sys.stdin.buffer, "standard input", form or "jsonl", None)
                continue
            with opened(Path(file)) as stream:
                about = os.fstat(stream.fileno())
                size = about.st_size if stat.S_ISREG(about.st_mode) else None
                yield from answers_in(stream, file, form or format_of(file), size)
        except RulecError as error:
            yield [error], 0, NotJudged(None, error)
