"""``rulec fleet``: all drives of many files judged, on an engine that there is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rulec.batch.jobs import Jobs
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import scenario_options
from rulec.cli.options import shared_options as shared
from rulec.cli.output import read_machines
from rulec.cli.standard_input import not_standard_input
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import print_result, progress

if TYPE_CHECKING:
    from rulec.trace.trace_model import Ending


@click.command()
@click.argument(
    "inputs",
    nargs=-1,
    required=True,
    metavar="INPUT...",
    callback=not_standard_input("each process reads its part of a file by itself"),
)
@shared.rulebook_option()
@click.option(
    "-o",
    "--output",
    "folder",
    required=True,
    metavar="DIR",
    type=click.Path(file_okay=False, path_type=Path),
    help="The folder of the findings. A run that was stopped goes on there.",
)
@shared.choice_option("--engine", ["local", "ray", "spark"], "Who gives the work to processes.")
@shared.jobs_option("Judge so many recordings, or pieces of tables, at a time")
@click.option(
    "--end",
    "ends",
    type=click.Choice(["cut", "complete"]),
    help="Of traces: cut out of something longer, or over at their end.  [default: as they say, "
    "else complete]",
)
@scenario_options.drives_options
@scenario_options.recording_options
@shared.at_option
def command(
    inputs: tuple[str, ...],
    rulebook: str,
    folder: Path,
    engine: Any,
    jobs: Jobs,
    ends: Ending | None,
    at: str,
    **options: Any,
) -> int:
    """Judge all drives in INPUT..., and write findings as Parquet into DIR.

    INPUT is a Parquet table of traces, or of tracks with a column `recording`, or recorded traffic
    of any format that `rulec formats` lists, or a folder of such files, or a pattern. Rows of a
    drive may be spread over tables.

    DIR gets a manifest and the folder `book=HASH` with a file for each recording and piece
    of a table: a row for each drive, for each rule of it, and for each finding (docs/fleet.md).
    Started again, the same command judges only what is missing.

    Exit status: 0 no hard rule is violated, 1 one is, 2 a file, a recording or a trace could not be
    judged, or no drive.
    """
    # numpy, shapely and formats of recordings, 250 ms: not for --help.
    from rulec.fleet.runs.fleet_run import FleetSettings, run_fleet
    from rulec.fleet.runs.fleet_summary import as_text

    rules = read_machines(rulebook, at)
    settings = FleetSettings(
        scenario_options.requested_drives((), options, rules.vocabulary),
        scenario_options.recording_source("-", options),
        ends,
        engine,
        jobs,
    )
    with progress("judging drives", 1) as tell:
        run = run_fleet(
            inputs, rules, folder, settings, lambda done, total: tell(done / max(total, 1))
        )
    complaints = Complaints()
    for problem in run.problems:
        complaints.add(problem)
    complaints.close()
    print_result(as_text(run))
    tally = run.tally
    answered = bool(tally.judged) and not (tally.unread or tally.lost or run.problems)
    return ExitStatus.after(answered=answered, failed=bool(tally.drives["violated"]))
