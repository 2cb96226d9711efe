"""``rulec verify``: traces and recorded traffic judged by a rulebook."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import click

import rulec
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.recording_options import (
    drives_options,
    egos_option,
    given_drives_option,
    requested_drives,
)
from rulec.cli.options.shared_options import (
    at_option,
    json_option,
    net_option,
    rulebook_option,
    table_format_option,
)
from rulec.cli.project import read_machines
from rulec.diagnostics import RulecError
from rulec.files import opened
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import print_result, progress

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.extraction.selection import RequestedDrives
    from rulec.monitoring.verdict import NotJudged, Verdict
    from rulec.trace import Trace
    from rulec.trace.formats.trace_files import Format

    Answer = tuple[Sequence[Trace | RulecError], int, Verdict | NotJudged]


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@rulebook_option()
@click.option(
    "--explain",
    "n_explained",
    type=click.IntRange(min=0),
    metavar="N",
    help="Explain the first N violations state by state.  [default: 1; with --json 0]",
)
@click.option(
    "--every-part",
    is_flag=True,
    help="Explain by every part of a formula and every state, however large the table becomes.",
)
@table_format_option("traces")
@egos_option
@drives_options
@net_option
@json_option
@at_option
def command(
    files: tuple[str, ...],
    rulebook: str,
    n_explained: int | None,
    every_part: bool,
    form: Format | None,
    json_output: bool,
    at: str,
    net: Path | None,
    egos: tuple[str, ...],
    **options: Any,
) -> int:
    """Judge the traces in FILE..., as JSON Lines, CSV or Parquet; `-` is standard input.

    Prints the violations of every trace and a summary; with --json one line per trace. A trace that
    cannot be judged is reported and does not stop the others.

    FILE may also be recorded traffic: CommonRoad's (.xml), or SUMO's floating-car data. Then every
    vehicle is judged by what it did, and a table says who violated what.

    Exit status: 0 every hard rule is kept, 1 one is violated, 2 a trace could not be judged.
    """
    # Formats of recordings, 80 ms: not for --help.
    from rulec.scenario.scenario_files import is_recording

    rules = read_machines(rulebook, at)
    recordings = [file for file in files if is_recording(file)]
    if not recordings and (
        option := "--net" if net else "--ego" if egos else given_drives_option(options)
    ):
        raise click.UsageError(f"{option} is for recorded traffic, and there is none.")
    to_explain = n_explained if n_explained is not None else 0 if json_output else 1
    run = _Run(rules, json_output, Complaints(), to_explain, every_part)
    if recordings:
        about = requested_drives(egos, options, rules.vocabulary)
        for file in recordings:
            run.recording(file, net, about)
    if len(recordings) < len(files):
        run.traces([file for file in files if file not in recordings], form)
    run.complaints.close()
    return ExitStatus.after(answered=not run.not_answered, failed=run.violated)


@dataclass
class _Run:
    """Settings for every file, and the results so far."""

    rules: CompiledRulebook
    json_output: bool
    complaints: Complaints
    to_explain: int
    every_part: bool
    violated: bool = False
    not_answered: bool = False

    def traces(self, files: Sequence[str], form: Format | None) -> None:
        """Judge the traces of files, with one summary for all of them."""
        # Tables of automata and verdicts, 230 ms: not for --help, and not for recordings alone.
        from rulec.monitoring.batch.batch_verify import rulebook_for
        from rulec.monitoring.explain.explanation import explain
        from rulec.monitoring.verdict import Verdict
        from rulec.report.verdicts import verdict_json, verdict_report
        from rulec.trace import Trace

        satisfied = violated = not_judged = 0
        for traces, place, answer in _answers(files, form, self.rules):
            if isinstance(answer, Verdict):
                satisfied += answer.satisfied
                violated += not answer.satisfied
                if not (answer.violations or self.json_output):
                    continue
                used = rulebook_for(traces, place, self.rules)
                explained = []
                chosen = answer.violations[: self.to_explain]
                if chosen:
                    self.to_explain -= len(chosen)
                    trace = traces[place]
                    assert isinstance(trace, Trace), "what has a verdict is a trace"
                    explained = [explain(violation, trace, used) for violation in chosen]
                print_result(
                    verdict_json.as_json(answer, used, explained)
                    if self.json_output
                    else verdict_report.as_text(answer, used, explained, every_part=self.every_part)
                )
            else:
                not_judged += 1
                self.complaints.add(answer.error)
                if self.json_output:
                    print_result(verdict_json.not_judged_as_json(answer))
        if not self.json_output:
            print_result(verdict_report.summary(satisfied, violated, not_judged))
        self.violated |= violated > 0
        self.not_answered |= not_judged > 0

    def recording(self, file: str, net: Path | None, wanted: RequestedDrives) -> None:
        """Judge every drive of a recording."""
        # numpy and shapely, 250 ms: only for recordings.
        from rulec.extraction.recording_verdicts import DriveVerdict, ViolationTally
        from rulec.monitoring.explain.explanation import explain
        from rulec.monitoring.verdict import NotJudged, Verdict
        from rulec.report.verdicts import recording_table, verdict_report
        from rulec.report.verdicts import recording_table as report

        try:
            judged = rulec.verify_recording(file, self.rules, wanted, net)
        except RulecError as error:
            self.complaints.add(error)
            self.not_answered = True
            return
        tally = ViolationTally()
        blocks = []
        with progress(f"judging {file}", len(judged.egos)) as tell:
            for number, answer in enumerate(judged.answers(), 1):
                tell(number)
                tally.add(answer)
                explained = []
                if isinstance(answer, DriveVerdict) and isinstance(answer.answer, Verdict):
                    chosen = answer.answer.violations[: self.to_explain]
                    self.to_explain -= len(chosen)
                    explained = [
                        explain(violation, answer.drive.trace, judged.rules) for violation in chosen
                    ]
                    if explained:
                        details = verdict_report.as_text(
                            answer.answer, judged.rules, explained, every_part=self.every_part
                        )
                        blocks.append(f"\n{details}")
                elif isinstance(answer, DriveVerdict) and isinstance(answer.answer, NotJudged):
                    self.complaints.add(answer.answer.error)
                    self.not_answered = True
                if self.json_output:
                    print_result(recording_table.as_json(answer, judged, explained))
        if not self.json_output:
            print_result("\n".join([report.as_text(judged, tally), *blocks, report.summary(tally)]))
        self.violated |= bool(tally.violated)
        self.not_answered |= not tally.judged


def _answers(
    files: Sequence[str], form: Format | None, rules: CompiledRulebook
) -> Iterator[Answer]:
    """Traces, which of them, and its verdict, or why there is none."""
    # Tables of automata, 160 ms: as for ``_Run.traces``.
    from rulec.monitoring.batch.batch_verify import verify_items
    from rulec.monitoring.verdict import NotJudged
    from rulec.trace.formats.trace_files import format_of, read_chunks

    def judged(stream: IO[bytes], name: str, form: Format, size: int | None) -> Iterator[Answer]:
        with progress(f"judging {name}", size) as tell:
            for chunk in read_chunks(stream, name, form):
                traces, answers = verify_items(chunk, rules)
                for place, answer in enumerate(answers):
                    yield traces, place, answer
                if size is not None:
                    tell(stream.tell())

    for file in files:
        try:
            if file == "-":
                yield from judged(sys.stdin.buffer, "standard input", form or "jsonl", None)
                continue
            with opened(Path(file)) as stream:
                about = os.fstat(stream.fileno())
                size = about.st_size if stat.S_ISREG(about.st_mode) else None
                yield from judged(stream, file, form or format_of(file), size)
        except RulecError as error:
            yield [error], 0, NotJudged(None, error)
