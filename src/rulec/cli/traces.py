"""``rulec traces``: all maneuvers of a scenario as traces."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rulec.cli.arguments import chosen, complete_rulebooks, graph_options, traces_format_option

if TYPE_CHECKING:
    from rulec.trace import Trace
    from rulec.trace.formats import Format

MOST_TRACES = 10_000_000


@click.command()
@graph_options
@click.option(
    "-r",
    "--rulebook",
    metavar="R",
    help="Write the traces in this rulebook's words, with the partition that it reads.",
    shell_complete=complete_rulebooks,
)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FILE",
    type=click.Path(dir_okay=False, path_type=Path, allow_dash=True),
    help="The file to write; `-` is standard output.",
)
@click.option(
    "--limit",
    type=click.IntRange(min=1),
    metavar="N",
    help=f"Write the first N only; needed where there are more than {MOST_TRACES:,}.",
)
@traces_format_option
def command(
    scenario: str,
    rulebook: str | None,
    output: Path,
    limit: int | None,
    form: Format | None,
    **options: Any,
) -> None:
    """Write every maneuver of SCENARIO (a name or a file) as a trace: JSON Lines, CSV or Parquet.

    `rulec verify` reads the file. It appears whole or not at all.
    """
    from rulec.files import written_whole
    from rulec.report.console import print_diagnostics, print_result, progress
    from rulec.report.counts import shown_count
    from rulec.runtime.product import count_paths
    from rulec.scenario import load_scenario
    from rulec.settings import search_path
    from rulec.trace.formats import format_of, write_traces
    from rulec.trace.paths import all_traces
    from rulec.trace.tables import kinds_in
    from rulec.workflow import find_maneuvers, machines, navigation_graph

    scene = load_scenario(scenario, chosen(options))
    if rulebook is None:
        options["partition"] = options["partition"] or "paper"
        graph = navigation_graph(scene, **options).trace_graph()
    else:
        rules = machines(rulebook, search_path(), print_diagnostics)
        graph = find_maneuvers(scene, rules, **options).paths
    name = scene.name
    total = count_paths(graph)
    if limit is None and total > MOST_TRACES:
        raise click.UsageError(
            f"There are {shown_count(total)} traces; that would fill a disk. "
            "Name how many to write with --limit N, or count them with `rulec maneuvers`."
        )
    wanted = total if limit is None else min(limit, total)
    with progress(f"writing {output}", wanted) as tell:
        found = _told(all_traces(graph, name, wanted), tell)
        form = form or format_of(str(output))
        kinds = kinds_in(chain.from_iterable(graph.states))
        if str(output) == "-":
            write_traces(found, sys.stdout.buffer, "standard output", form, kinds)
            return
        with written_whole(output) as stream:
            write_traces(found, stream, str(output), form, kinds)
    print_result(f"wrote {wanted:,} of {shown_count(total)} traces to {output}")


def _told(traces: Iterable[Trace], tell: Callable[[float], None]) -> Iterator[Trace]:
    for number, trace in enumerate(traces):
        if number % 100 == 0:
            tell(number)
        yield trace
