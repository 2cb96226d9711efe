"""``rulec verify``: judge traces and recorded traffic by a rulebook."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import click

from rulec.batch.jobs import Jobs
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import (
    STANDARD_OUTPUT,
    TABLES,
    Output,
    output_options,
    refuse_overwriting,
)
from rulec.cli.options.recording_options import (
    RecordingOptions,
    TrafficOptions,
    as_typed,
    assumptions,
    traffic_options,
)
from rulec.cli.options.shared_options import refuse_unmatched, with_rules_like
from rulec.cli.options.verb_class import argument, gathered, option, verb
from rulec.cli.output import read_machines, rulebooks_named
from rulec.cli.verdict_outputs import FORMATS, VerdictOutputs, verdict_outputs
from rulec.recordings.recording_files import check_readable, is_recording
from rulec.recordings.recording_inputs import STANDARD_INPUT, InputFiles, input_files
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import page_width, print_remark
from rulec.trace.trace_model import Ending

_OF_SEVERAL_BOOKS = ("text", "json", "jsonl", "csv", "parquet")
"""The formats in which every line names its rulebook."""


@dataclass(frozen=True, kw_only=True)
class VerifyOptions:
    """How traces and drives are judged, and what is said of them."""

    n_explained: int | None = shared.number_option(
        "--explain",
        "Explain the first N violations of each file state by state.  [default: 1 for a "
        "single file of traces, 0 with --json]",
    )
    every_part: bool = option(
        "--every-part",
        is_flag=True,
        help="Show every part of the formula and every state in explanations, however large the "
        "table.",
    )
    why: bool = option(
        "--why",
        is_flag=True,
        help="Say of every rule whether something or nothing was found, it had no opportunity to "
        "be violated, or it is open or not judged, and which words are missing.",
    )
    strict: bool = option(
        "--strict",
        is_flag=True,
        help="Count open hard rules as violated: those undecided because values are unknown or the "
        "trace is cut.",
    )
    ends: Ending | None = shared.end_option
    step_s: Fraction | None = shared.step_option(
        "For traces: use S seconds as the time step. A trace whose own step differs by more "
        "than 5 % (more than the jitter of a logger's clock) is not judged."
    )
    traffic: TrafficOptions = traffic_options
    jobs: Jobs = shared.jobs_option("Judge N recordings, or parts of a long one, in parallel")


@verb
def command(
    *,
    files: tuple[str, ...] = argument(nargs=-1, required=True, metavar="FILE..."),
    rulebooks: tuple[str, ...] = shared.rulebooks_option(
        shared.RULEBOOK_HELP + " May be given several times, for verdicts side by side."
    ),
    patterns: tuple[str, ...] = shared.rules_option("Judge only by rules that match PATTERN"),
    asked: VerifyOptions = gathered(VerifyOptions),
    to: tuple[Output, ...] = output_options(
        FORMATS,
        "the answer",
        multiple=True,
        instead="Pictures and pages are drawn by `rulec draw`.",
    ),
    exposure: bool = option(
        "--exposure",
        is_flag=True,
        help="In .jsonl, .csv and .parquet also write a row per drive, and per rule with how often "
        "there was an opportunity to violate it, as input for `rulec rates`.",
    ),
    at: str = shared.at_option,
) -> int:
    """Judge the traces in FILE..., as JSON Lines, CSV or Parquet; `-` is standard input.

    Prints the violations of every trace and a summary; with --json one line per trace. A trace that
    cannot be judged is reported and does not stop the others.

    FILE may also be recorded traffic in any format listed by `rulec list formats`. Then the drive
    of every vehicle is judged, and a table shows who violated what. A folder stands for all
    recordings in it, at any depth, and a pattern such as `*.xml` for all files that match; several
    files get one line each and a common table.

    With several rulebooks, as in -r de -r fr or -r laws/, everything is judged by each of them, and
    a table compares the results.

    -o FILE writes findings: one per violation, open verdict or rule that could not be judged, as
    .jsonl, .csv, .parquet, .xml (JUnit), .sarif or .mcap (events for playback beside the
    recording). With .json it writes verdicts, like --json; with .txt the text.

    Exit status: 0 no hard rule is violated, 1 some are, 2 a trace, or every rule, could not be
    judged.
    """
    inputs = input_files(files)
    refuse_overwriting(to, inputs.paths)
    if asked.traffic.drives.thresholds:
        asked.traffic.drives.read_thresholds()
    references = list(dict.fromkeys(rulebooks_named(rulebooks)))
    own = [read_machines(name, at) for name in references]
    refuse_unmatched(patterns, own)
    books = _told_apart([with_rules_like(book, patterns) for book in own], references)
    if len(books) > 1 and STANDARD_OUTPUT in inputs.paths:
        raise click.UsageError("standard input is read once; give a file, or one rulebook")
    recordings = _recordings(inputs, asked.traffic.recorded)
    is_json_alone = to == (Output(STANDARD_OUTPUT, "json"),)
    is_small = len(inputs.paths) == len(books) == 1 and not recordings
    usual = 1 if is_small and not is_json_alone else 0
    request = VerifyRequest(
        inputs=inputs,
        recordings=recordings,
        traces=[path for path in inputs.paths if path not in recordings],
        asked=asked,
        traffic=asked.traffic,
        n_explained=usual if asked.n_explained is None else asked.n_explained,
    )
    _check_inputs(request)
    _check_outputs(request, to, n_books=len(books))
    for searched in inputs.searched:
        print_remark(f"rulec: {searched.in_words}")
    if exposure and not any(output.form in TABLES for output in to):
        raise click.UsageError("--exposure is for tables: -o FILE.jsonl, FILE.csv, FILE.parquet.")
    if exposure and patterns:
        raise click.UsageError("--exposure is for all rules of a rulebook: leave out --rule.")
    with verdict_outputs(to, books[0], with_rows=exposure, strict=asked.strict) as outputs:
        complaints = Complaints()
        results: list[list[lazy.VerdictRun]] = []
        failed = False
        for rules, rows_of, reference in zip(books, own, references, strict=True):
            if rules.law or len(books) > 1:
                headline = lazy.verdict_report.headline(rules, page_width())
                outputs.heading(f"{'' if rules is books[0] else chr(10)}{headline}")
            if exposure:
                outputs.to_rows = _to_rows(rows_of, rules.name, request)
            named = ["-r", reference, *(("--at", at) if at else ())]
            own_request = replace(request, traffic=_speaking_of(rules, books, asked.traffic))
            runs = _judge(own_request, rules, outputs, complaints, named)
            for run in runs:
                failed |= run.has_failed(strict=asked.strict)
            results.append(runs)
        if len(books) > 1:
            totals = [lazy.BatchTally.sum_of(run.total for run in runs) for runs in results]
            tallies = list(zip(books, totals, strict=True))
            outputs.text(f"\n{lazy.as_columns(tallies, page_width())}")
    complaints.close()
    answered = all(any(run.judged for run in runs) for runs in results)
    is_complete = all(run.complete for runs in results for run in runs)
    return ExitStatus.after(answered=answered and is_complete, failed=failed)


def _speaking_of(
    rules: lazy.CompiledRulebook, books: Sequence[lazy.CompiledRulebook], traffic: TrafficOptions
) -> TrafficOptions:
    """The options without assumptions about words that another of the rulebooks knows alone."""

    def is_others(text: str) -> bool:
        name = text.partition("=")[0].strip()
        knowing = [book for book in books if name in book.vocabulary.declarations]
        return bool(knowing) and all(book is not rules for book in knowing)

    assumed = tuple([text for text in traffic.drives.assumed if not is_others(text)])
    return replace(traffic, drives=replace(traffic.drives, assumed=assumed))


def _told_apart(
    books: list[lazy.CompiledRulebook], references: Sequence[str]
) -> list[lazy.CompiledRulebook]:
    """The rulebooks under distinct names."""
    if len({book.name for book in books}) == len(books):
        return books
    return lazy.renamed_rulebook.with_distinct_names(books, references)


@dataclass(frozen=True, kw_only=True)
class VerifyRequest:
    """Files of recordings and of traces, and how to judge them."""

    inputs: InputFiles
    recordings: Sequence[str]
    traces: Sequence[str]
    asked: VerifyOptions
    traffic: TrafficOptions
    n_explained: int


def _check_inputs(request: VerifyRequest) -> None:
    """Refuse options that do not apply to the files. Raises click.UsageError, RulecError."""
    drives, recorded = request.traffic.drives, request.traffic.recorded
    only_drives = replace(drives, assumed=()), replace(recorded, input_format=None)
    given = "--ego" if request.traffic.egos else next(as_typed(*only_drives), None)
    if given and not request.recordings and not request.inputs.problems:
        for path in request.inputs.paths:
            if path != STANDARD_INPUT:
                check_readable(Path(path))
        raise click.UsageError(
            f"{given} is for recorded traffic, and no file looks like it; add `--input-format "
            "tracks`, or another of `rulec list formats`, to learn what is missing"
        )
    if request.asked.ends is not None and request.recordings:
        raise click.UsageError("--end is for traces; a recording is always cut.")
    step_s = request.asked.step_s
    if step_s is not None and (request.recordings or Fraction(str(float(step_s))) != step_s):
        raise click.UsageError("--step is a decimal, and for traces; a recording has its own step.")


def _check_outputs(request: VerifyRequest, to: Sequence[Output], *, n_books: int) -> None:
    """Refuse formats that cannot hold all that is requested. Raises click.UsageError."""
    for output in to if n_books > 1 else ():
        if output.form not in _OF_SEVERAL_BOOKS:
            raise click.UsageError(
                f"{output.form} can contain only one rulebook; for several give one of "
                f"{', '.join(_OF_SEVERAL_BOOKS)}, or judge by each in a call of its own"
            )
    if len(request.recordings) > 1 and any(printed.form == "mcap" for printed in to):
        raise click.UsageError("MCAP has one time line: give one recording.")


def _judge(
    request: VerifyRequest,
    rules: lazy.CompiledRulebook,
    outputs: VerdictOutputs,
    complaints: Complaints,
    named: Sequence[str],
) -> list[lazy.VerdictRun]:
    """Judge all files by one rulebook; the options that it was ``named`` by are for messages."""
    asked, traffic = request.asked, request.traffic
    runs: list[lazy.VerdictRun] = []
    if request.recordings or request.inputs.problems:
        to_rows = outputs.to_rows
        source = (*request.recordings, *named, *as_typed(traffic.drives, traffic.recorded))
        settings = lazy.JudgeSettings(
            rules,
            traffic.requested(rules.vocabulary),
            traffic.recorded.source("-"),
            to_explain=request.n_explained,
            every_part=asked.every_part,
            layout=lazy.AnswerLayout(page_width(), asked.why, source) if outputs.texts else None,
            findings=bool(outputs.writers),
            to_line=lazy.recording_line if outputs.lines else None,
            to_rows=None if to_rows is None else to_rows.of_answer,
            opportunities=lazy.opportunities_of if asked.why else None,
        )
        recorded = lazy.RecordingRun(rules, outputs, complaints, settings=settings)
        for problem in request.inputs.problems:
            recorded.not_read(problem)
        if request.recordings:
            recorded.files(request.recordings, asked.jobs)
        runs.append(recorded)
    if request.traces:
        assumed = assumptions(asked.ends, traffic.drives.assumed, rules.vocabulary)
        step = None if asked.step_s is None else float(asked.step_s)
        n_explained, every_part = request.n_explained, asked.every_part
        traced = lazy.TraceRun(
            rules, outputs, complaints, to_explain=n_explained, every_part=every_part
        )
        traced.files(request.traces, traffic.recorded.trace_format, replace(assumed, step_s=step))
        runs.append(traced)
    return runs


def _to_rows(rules: lazy.CompiledRulebook, name: str, request: VerifyRequest) -> lazy.DriveRows:
    """The builder of rows of drives and rules; in them the rulebook has this name.

    Its hash remains that of the rulebook itself, by which findings of other calls have it.
    """
    wanted = request.traffic.requested(rules.vocabulary)
    by = lazy.judged_by(rules, wanted, request.asked.ends or "")
    return lazy.DriveRows(rules, replace(by, rulebook=name))


def _recordings(inputs: InputFiles, recorded: RecordingOptions) -> list[str]:
    """The files that are recorded traffic; if the format is given, all or none of them."""
    if recorded.trace_format is not None:
        return []
    if recorded.input_format is not None:
        return list(inputs.paths)
    return [path for path in inputs.paths if path != STANDARD_INPUT and is_recording(path)]
