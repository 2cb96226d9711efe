"""``rulec envelopes``: the bounds of maneuvers as a table."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.scenario_options import chosen, graph_options
from rulec.cli.options.shared_options import at_option, output_option, rulebook_option

if TYPE_CHECKING:
    from rulec.trace.formats.trace_files import Format


@click.command()
@graph_options
@rulebook_option
@output_option
@click.option(
    "--list",
    "number",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    metavar="N",
    help="Write the N cheapest satisfying maneuvers.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["jsonl", "csv", "parquet"]),
    help="The format of the table.  [default: what the file's name ends with, else jsonl]",
)
@at_option
def command(
    scenario: str,
    rulebook: str,
    output: Path,
    number: int,
    form: Format | None,
    at: str,
    **options: Any,
) -> int:
    """Write the envelopes of the cheapest satisfying maneuvers of SCENARIO (a name or a file).

    A table in JSON Lines, CSV or Parquet: what bounds a maneuver in each layer, piece by piece.

    Exit status: 0 there is a satisfying maneuver, 1 there is none, 2 it could not be answered.
    """
    from rulec.api.workflow import find_maneuvers, machines
    from rulec.files import written_whole
    from rulec.report.maneuvers.envelope_table import write_envelopes
    from rulec.report.text.console import print_diagnostics, print_result
    from rulec.report.text.count_text import shown_count
    from rulec.scenario import load_scenario
    from rulec.settings import search_path
    from rulec.trace.formats.trace_files import format_of

    rules = machines(rulebook, search_path(), print_diagnostics, at)
    scene = load_scenario(scenario, chosen(options))
    maneuvers = find_maneuvers(scene, rules, **options)
    cheapest = maneuvers.cheapest(number)
    form = form or format_of(str(output))
    if str(output) == "-":
        write_envelopes(maneuvers.graph, cheapest, sys.stdout.buffer, "standard output", form)
    else:
        with written_whole(output) as stream:
            write_envelopes(maneuvers.graph, cheapest, stream, str(output), form)
        written = f"{len(cheapest):,} of {shown_count(maneuvers.satisfying)} satisfying maneuvers"
        print_result(f"wrote {written} to {output}")
    return ExitStatus.OK if cheapest else ExitStatus.VIOLATED
