"""``rulec maneuvers``: the maneuvers of a scenario, judged by a rulebook."""

from __future__ import annotations

import time
from typing import Any

import click

from rulec.cli.arguments import at_option, graph_options, json_option, rulebook_option
from rulec.cli.exit_status import ExitStatus


@click.command()
@graph_options
@rulebook_option
@click.option(
    "--list",
    "n_listed",
    type=click.IntRange(min=0),
    metavar="N",
    help="List the N cheapest satisfying maneuvers.",
)
@json_option
@at_option
def command(
    scenario: str, rulebook: str, n_listed: int | None, json_output: bool, at: str, **options: Any
) -> int:
    """Count the maneuvers of SCENARIO (a name or a file) that satisfy every hard rule.

    Exit status: 0 there is a satisfying maneuver, 1 there is none, 2 it could not be answered.
    """
    from rulec.report import maneuvers as report
    from rulec.report.console import print_diagnostics, print_result
    from rulec.settings import search_path
    from rulec.workflow import find_maneuvers, machines

    begin = time.perf_counter()
    rules = machines(rulebook, search_path(), print_diagnostics, at)
    found = find_maneuvers(scenario, rules, **options)
    listed = None if n_listed is None else found.cheapest(n_listed)
    seconds = time.perf_counter() - begin
    if json_output:
        print_result(report.as_json(found, listed, seconds))
    else:
        print_result(report.as_text(found, listed, seconds))
    return ExitStatus.OK if found.satisfying else ExitStatus.VIOLATED
