"""``rulec find``: the moments at which a formula holds."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import (
    STANDARD_OUTPUT,
    TABLES,
    Output,
    endings_of,
    output_options,
    refuse_overwriting,
)
from rulec.cli.options.recording_options import TrafficOptions, assumptions, traffic_options
from rulec.cli.options.standard_input import input_stream, not_standard_input
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import answer_lines, output_stream, print_written
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.fault_messages import contained
from rulec.recordings.recording_files import is_recording, read_recordings
from rulec.recordings.recording_inputs import input_files
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import page_width
from rulec.rulebook.query_model import FormulaQuery
from rulec.settings import search_path

FORMATS = {**endings_of("text", "json"), **TABLES}


@verb
def command(
    *,
    formula: str = argument(),
    files: tuple[str, ...] = argument(nargs=-1, required=True, metavar="FILE..."),
    vocabulary: str = option(
        "-u",
        "--use",
        default="",
        metavar="NAME",
        callback=not_standard_input(
            "a vocabulary is found by its name; give a rulebook, as `-r -`"
        ),
        help="The vocabulary that the formula uses.  [default: road, or the rulebook's]",
    ),
    rulebook: str | None = shared.rulebook_option(
        "a formula is in the words of one rulebook",
        "A rulebook (name or source) whose words, definitions and parameters the formula may use, "
        "in addition to those of --use.",
        required=False,
    ),
    sure: bool = option(
        "--sure",
        is_flag=True,
        help="List only moments that are certain, whatever the unknown values are.",
    ),
    traffic: TrafficOptions = traffic_options,
    to: Output = output_options(FORMATS, "the moments"),
    at: str = shared.at_option,
) -> int:
    """List the moments at which FORMULA holds in FILE..., recorded traffic or traces.

    FORMULA is written in the rule language. Its variables and their types come first, as in the
    head of a rule: '(v: vehicle) same_lane(v) and gap(v) < 5 m'. It is evaluated in every state of
    every drive, for every choice of distinct objects; temporal operators look back and ahead from
    that state.

    Each moment is listed with its drive, its objects, its start and end in seconds, and its states.
    Moments that are uncertain are marked as such; --sure leaves them out.

    Exit status: 0, or 2 if a file or a trace could not be read.
    """
    if os.path.isfile(formula) and not any(map(os.path.exists, files)):  # noqa: PTH113 - Path raises on a null character
        raise click.UsageError(
            f"`{formula}` is a file: the formula comes first, as in `rulec find '{files[0]}' "
            f"{formula}`"
        )
    inputs = input_files(files)
    refuse_overwriting((to,), inputs.paths)
    query = lazy.read_query(
        formula,
        rulebook=rulebook or "",
        vocabulary=vocabulary,
        search_path=search_path(),
        at=at,
    )
    complaints = Complaints(inputs.problems)
    tally = lazy.moment_rows.MomentTally()

    def found() -> Iterator[lazy.DriveMoments]:
        for drive in moments_of(query, inputs.paths, traffic, complaints):
            if sure:
                kept = [moment for moment in drive.moments if moment.holds == "surely"]
                drive = replace(drive, moments=kept)
            tally.add(drive)
            yield drive

    if to.form in ("text", "json", "jsonl"):
        lines_of = partial(lazy.moment_rows.lines, width=page_width())
        as_lines = lines_of if to.form == "text" else lazy.moment_rows.json_lines
        with answer_lines(to) as write:
            for drive in found():
                for line in as_lines(drive):
                    write(line)
            if to.form == "text":
                write(tally.as_text())
    else:
        with output_stream(to) as (stream, name):
            writer = lazy.RowWriter(to.form, stream, name, lazy.moment_rows.COLUMNS)
            for drive in found():
                writer.add(lazy.moment_rows.rows(drive))
            writer.close()
    print_written(to.path, to)
    complaints.close()
    return ExitStatus.after(answered=not complaints, failed=False)


def moments_of(
    query: FormulaQuery,
    paths: Sequence[str],
    traffic: TrafficOptions,
    complaints: Complaints,
    look: lazy.Look | None = None,
) -> Iterator[lazy.DriveMoments]:
    """The moments of all drives of all files, or whatever else one is to ``look`` for.

    ``complaints`` gets the errors of what could not be read.
    """
    look = look or lazy.moments
    recorded, form = traffic.recorded, traffic.recorded.trace_format
    named = recorded.input_format is not None
    wanted, source = traffic.requested(query.vocabulary), recorded.source("-")
    assumed = assumptions(None, traffic.drives.assumed, query.vocabulary)
    for path in paths:
        is_stream = path == STANDARD_OUTPUT
        found: Iterable[lazy.DriveMoments | RulecError] = ()
        try:
            with ExitStack() as stack:
                stack.enter_context(contained("not searched", SourceLocation(path)))
                if form is None and (named or (not is_stream and is_recording(path))):
                    recordings = read_recordings(replace(source, path=Path(path)))
                    found = lazy.in_recordings(recordings, query, wanted, path, look)
                else:
                    stream, name = stack.enter_context(input_stream(path))
                    own = form or ("jsonl" if is_stream else lazy.format_of(path))
                    traces = chain.from_iterable(lazy.read_chunks(stream, name, own))
                    found = lazy.in_traces(traces, query, assumed, path, look)
                for drive in found:
                    if isinstance(drive, RulecError):
                        complaints.add(drive)
                    else:
                        yield drive
        except RulecError as error:
            complaints.add(error)
