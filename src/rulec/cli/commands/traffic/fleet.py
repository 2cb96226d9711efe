"""``rulec fleet``: judge all drives of many files, on a chosen engine."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.bundle.renamed_rulebook import with_distinct_names
from rulec.batch.jobs import Jobs
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.recording_options import (
    DrivesOptions,
    RecordingOptions,
    drives_options,
    recording_options,
)
from rulec.cli.options.standard_input import not_standard_input
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import read_machines, rulebooks_named, told_apart
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import print_result, progress
from rulec.trace.trace_model import Ending


@verb
def command(
    *,
    inputs: tuple[str, ...] = argument(
        nargs=-1,
        required=True,
        metavar="INPUT...",
        callback=not_standard_input("each process reads its part of a file by itself"),
    ),
    rulebooks: tuple[str, ...] = shared.rulebooks_option(
        shared.RULEBOOK_HELP + " May be given several times, for findings side by side."
    ),
    folder: Path = option(
        "-o",
        "--output",
        required=True,
        metavar="DIR",
        type=click.Path(file_okay=False, path_type=Path),
        help="The folder for the findings; with several rulebooks it gets a folder for each. An "
        "interrupted run is resumed from it.",
    ),
    on: Any = shared.choice_option(
        "--on", ["local", "ray", "spark"], "What distributes the work.", former=["--engine"]
    ),
    jobs: Jobs = shared.jobs_option("Judge N recordings, or pieces of tables, in parallel"),
    ends: Ending | None = shared.end_option,
    drives: DrivesOptions = drives_options,
    recorded: RecordingOptions = recording_options,
    at: str = shared.at_option,
) -> int:
    """Judge all drives in INPUT... and write the findings as Parquet files to DIR.

    INPUT is a Parquet table of traces, a Parquet table of tracks with a column `recording`,
    recorded traffic in any format listed by `rulec list formats`, a folder of such files, or a
    pattern. The rows of a drive may be spread over several tables.

    DIR gets a manifest and a folder `book=HASH` with a file for each recording or piece of a table;
    it has a row for each drive, for each rule of the drive, and for each finding (docs/fleet.md).
    Run again, the same command judges only what is missing. With several rulebooks, as in -r de
    -r fr or -r laws/, each has a folder DIR/RULEBOOK, and a table compares them.

    Exit status: 0 no hard rule is violated, 1 some are, 2 a file, recording or trace could not be
    judged, or no drive could.
    """
    named = told_apart(rulebooks_named(rulebooks))
    books = {name: read_machines(reference, at) for name, reference in named.items()}
    runs: list[tuple[CompiledRulebook, lazy.FleetRun]] = []
    complaints = Complaints()
    for name, rules in books.items():
        settings = lazy.FleetSettings(
            drives.requested((), rules.vocabulary),
            recorded.source("-"),
            ends,
            on,
            jobs,
        )
        own = folder if len(books) == 1 else folder / name
        with progress("judging drives", 1) as tell:
            run = lazy.run_fleet(
                inputs, rules, own, settings, lambda done, total: tell(done / max(total, 1))
            )
        for problem in run.problems:
            complaints.add(problem)
        runs.append((rules, run))
    complaints.close()
    print_result("\n\n".join(lazy.fleet_summary.as_text(run) for _, run in runs))
    if len(runs) > 1:
        distinct = with_distinct_names(list(books.values()), list(named.values()))
        columns = [(rules, run) for rules, (_, run) in zip(distinct, runs, strict=True)]
        print_result(f"\n{lazy.fleet_summary.compared(columns)}")
    return ExitStatus.after(
        answered=all(run.is_complete for _, run in runs),
        failed=any(run.tally.drives["violated"] for _, run in runs),
    )
