"""``rulec traces``: all maneuvers of a scenario, or what recorded vehicles did, as traces."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rulec.cli.options.recording_options import drives_options, given, wanted
from rulec.cli.options.scenario_options import chosen, graph_options
from rulec.cli.options.shared_options import output_option, traces_format_option
from rulec.cli.options.shell_completion import complete_rulebooks

if TYPE_CHECKING:
    from rulec.trace import Trace
    from rulec.trace.formats.trace_files import Format

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
@output_option
@click.option(
    "--limit",
    type=click.IntRange(min=1),
    metavar="N",
    help=f"Write the first N only; needed where there are more than {MOST_TRACES:,}.",
)
@click.option(
    "--recorded",
    is_flag=True,
    help="Of recorded traffic: write what its vehicles did, every one or that of --ego, instead of "
    "what ego could do.",
)
@traces_format_option
@drives_options
def command(
    scenario: str,
    rulebook: str | None,
    output: Path,
    limit: int | None,
    recorded: bool,
    form: Format | None,
    thresholds: tuple[str, ...],
    assumed: tuple[str, ...],
    as_recorded: bool,
    **options: Any,
) -> None:
    """Write every maneuver of SCENARIO (a name or a file) as a trace: JSON Lines, CSV or Parquet.

    With --recorded, what the vehicles of recorded traffic did. `rulec verify` reads the file. It
    appears whole or not at all.
    """
    about = {"thresholds": thresholds, "assumed": assumed, "as_recorded": as_recorded}
    if recorded:
        _write_drives(Path(scenario), rulebook, output, limit, form, options, about)
        return
    if option := given(about):
        raise click.UsageError(f"{option} is for drives: add --recorded.")
    from rulec.api.workflow import find_maneuvers, machines, navigation_graph
    from rulec.files import written_whole
    from rulec.planning.product.graph_product import count_paths
    from rulec.report.text.console import print_diagnostics, print_result, progress
    from rulec.report.text.count_text import shown_count
    from rulec.scenario import load_scenario
    from rulec.settings import search_path
    from rulec.trace.formats.table_writer import kinds_in
    from rulec.trace.formats.trace_files import format_of, write_traces
    from rulec.trace.graph_paths import all_traces

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
        traces = _told(all_traces(graph, name, wanted), tell)
        form = form or format_of(str(output))
        kinds = kinds_in(chain.from_iterable(graph.states))
        if str(output) == "-":
            write_traces(traces, sys.stdout.buffer, "standard output", form, kinds)
            return
        with written_whole(output) as stream:
            write_traces(traces, stream, str(output), form, kinds)
    print_result(f"wrote {wanted:,} of {shown_count(total)} traces to {output}")


_OF_DRIVES = {"ego", "net"}
"""The options for recorded scenes that mean something for drives, too."""


def _write_drives(
    file: Path,
    rulebook: str | None,
    output: Path,
    limit: int | None,
    form: Format | None,
    options: Mapping[str, Any],
    about: Mapping[str, Any],
) -> None:
    """Write what the vehicles of a recording did."""
    from rulec.api.workflow import machines
    from rulec.diagnostics import SourceLocation
    from rulec.extraction.selection.requested import selected_drives
    from rulec.extraction.to_trace import Drive
    from rulec.files import written_whole
    from rulec.report.text.console import print_diagnostics, print_result, progress
    from rulec.scenario.recording_files import read_recording
    from rulec.scenario.scenario_messages import NOT_IN_RECORDING
    from rulec.settings import search_path
    from rulec.trace.formats.trace_files import format_of, write_traces

    if (option := _given_of_maneuvers(options)) is not None:
        raise click.UsageError(f"{option} is for maneuvers, not for what is --recorded.")
    book = None
    if rulebook is not None:
        book = machines(rulebook, search_path(), print_diagnostics)
    vocabulary = None if book is None else book.vocabulary
    egos = () if options["ego"] is None else (options["ego"],)
    result = selected_drives(
        read_recording(file, options["net"]),
        wanted(egos, about, vocabulary),
        str(file),
        "" if book is None else book.traffic,
        vocabulary,
    )
    count = 0

    def traces() -> Iterator[Trace]:
        nonlocal count
        for number, ego in enumerate(result.egos, 1):
            tell(number)
            for drive in result.of(ego):
                if isinstance(drive, Drive) and (limit is None or count < limit):
                    count += 1
                    yield drive.trace

    kinds = result.drives.kinds()
    if not kinds:
        message = "nobody in this recording drives on a lane"
        raise NOT_IN_RECORDING.error(SourceLocation(str(file)), message)
    with progress(f"writing {output}", len(result.egos)) as tell:
        form = form or format_of(str(output))
        if str(output) == "-":
            write_traces(traces(), sys.stdout.buffer, "standard output", form, kinds)
            return
        with written_whole(output) as stream:
            write_traces(traces(), stream, str(output), form, kinds)
    print_result(f"wrote {count:,} drives to {output}")


def _given_of_maneuvers(options: Mapping[str, Any]) -> str | None:
    """An option that somebody has given and that means nothing for drives, if any."""
    context = click.get_current_context()
    typed = click.core.ParameterSource.COMMANDLINE
    for parameter in context.command.params:
        name = parameter.name or ""
        is_typed = context.get_parameter_source(name) is typed
        if is_typed and name in options and name not in _OF_DRIVES:
            return parameter.opts[0]
    return None


def _told(traces: Iterable[Trace], tell: Callable[[float], None]) -> Iterator[Trace]:
    for number, trace in enumerate(traces):
        if number % 100 == 0:
            tell(number)
        yield trace
