"""``rulec envelopes``: the bounds of maneuvers as a table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import rulec
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.scenario_options import (
    graph_options,
    read_scene,
    reading_options,
    scene_reading,
)
from rulec.cli.output import output_stream, print_written, read_machines
from rulec.report.text.terminal_text import shown_count

if TYPE_CHECKING:
    from rulec.trace.formats.trace_files import Format


@click.command()
@graph_options
@shared.rulebook_option()
@shared.output_option
@shared.number_option(
    "--list", "number", "Write the N cheapest satisfying maneuvers.", least=1, default=1
)
@shared.table_format_option("table")
@reading_options
@shared.at_option
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
    # Maneuvers and the formats of tables, 100 ms: not for --help.
    from rulec.report.maneuvers.envelope_table import write_envelopes
    from rulec.trace.formats.trace_files import format_of

    rules = read_machines(rulebook, at)
    reading = scene_reading(options, rules.vocabulary)
    scene = read_scene(scenario, options)
    maneuvers = rulec.find_maneuvers(scene, rules, **reading, **options)
    cheapest = maneuvers.cheapest(number)
    form = form or format_of(str(output))
    with output_stream(output) as (stream, name):
        write_envelopes(maneuvers.graph, cheapest, stream, name, form)
    satisfying = shown_count(maneuvers.satisfying)
    print_written(f"{len(cheapest):,} of {satisfying} satisfying maneuvers to {output}", output)
    return ExitStatus.OK if cheapest else ExitStatus.VIOLATED
