"""``rulec maneuvers --envelopes``: the bounds of maneuvers as a table."""

from __future__ import annotations

from typing import cast

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import TABLES, Output, output_options
from rulec.cli.options.scenario_options import (
    ReadingOptions,
    SceneOptions,
    cell_options,
    reading_options,
    scenario_argument,
)
from rulec.cli.options.verb_class import verb
from rulec.cli.output import output_stream, print_written, read_machines
from rulec.diagnostics import SourceLocation
from rulec.diagnostics.fault_messages import contained
from rulec.report.text.console import print_remark
from rulec.report.text.terminal_text import shown_count

_WHY_ONE = "a planner's table has the maneuvers of one rulebook"


@verb
def command(
    *,
    scenario: str = scenario_argument,
    cut: SceneOptions = cell_options,
    rulebook: str = shared.rulebook_option(_WHY_ONE),
    to: Output = output_options(TABLES, "the table", required=True, former=["--format"]),
    number: int = shared.number_option(
        "--list", "Write the N cheapest satisfying maneuvers.", least=1, default=1
    ),
    missing: ReadingOptions = reading_options,
    at: str = shared.at_option,
) -> int:
    """Write the envelopes of the cheapest satisfying maneuvers of SCENARIO (a name or a file).

    The table (JSON Lines, CSV or Parquet) has the bounds of each maneuver in each layer, stretch by
    stretch. Where values are unknown, open maneuvers are included.

    Exit status: 0 there is a satisfying or open maneuver, 1 there is none, 2 the scenario could not
    be evaluated.
    """
    rules = read_machines(rulebook, at)
    reading = missing.reading(rules.vocabulary)
    scene = cut.scene(scenario)
    with contained("no answer", SourceLocation(scenario)):
        maneuvers = rulec.find_maneuvers(scene, rules, **reading, **cut.cells())
        cheapest = maneuvers.cheapest(number, perhaps=True)
    with output_stream(to) as (stream, name):
        lazy.write_envelopes(maneuvers.graph, cheapest, stream, name, cast("lazy.Format", to.form))
    account = maneuvers.graph.scenario.account
    if account is not None and account.mirrored:
        print_remark("rulec: mirrored: d is positive to the right of what was recorded")
    legal = shown_count(maneuvers.satisfying + maneuvers.open)
    outcome = "satisfying or open" if maneuvers.open else "satisfying"
    print_written(f"{len(cheapest):,} of {legal} {outcome} maneuvers to {to.path}", to)
    return ExitStatus.OK if cheapest else ExitStatus.VIOLATED
