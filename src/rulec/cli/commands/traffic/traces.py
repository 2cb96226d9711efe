"""``rulec maneuvers --traces``: write maneuvers of a scenario, or recorded drives, as traces."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from dataclasses import fields
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import TypeVar, cast

import click
from click.core import ParameterSource

import rulec
from rulec.batch.jobs import Jobs
from rulec.cli import lazy_imports as lazy
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import TABLES, Output, output_options
from rulec.cli.options.recording_options import (
    DrivesOptions,
    RecordingOptions,
    as_typed,
    drives_options,
)
from rulec.cli.options.scenario_options import SceneOptions, cell_options, scenario_argument
from rulec.cli.options.standard_input import file_named
from rulec.cli.options.verb_class import option, verb
from rulec.cli.output import output_stream, print_lost, print_written, read_machines
from rulec.diagnostics import SourceLocation
from rulec.diagnostics.fault_messages import contained
from rulec.monitoring.state_validation import partial_names
from rulec.report.text.console import progress
from rulec.report.text.terminal_text import shown_count
from rulec.trace.trace_model import all_traces

MOST_TRACES = 10_000_000
_ALOUD = 100
"""Progress is reported every so many traces."""

Piece = TypeVar("Piece")


@verb
def command(
    *,
    scenario: str = scenario_argument,
    cut: SceneOptions = cell_options,
    rulebook: str | None = shared.rulebook_option(
        "a file of traces is in the words of one rulebook",
        "Write the traces in this rulebook's words, with the partition that it needs.",
        required=False,
    ),
    to: Output = output_options(TABLES, "the traces", required=True, former=["--format"]),
    first: int | None = shared.number_option(
        "--first",
        f"Write only the first N; required if there are more than {MOST_TRACES:,}.",
        least=1,
        former=["--limit"],
    ),
    recorded: bool = option(
        "--recorded",
        is_flag=True,
        help="For recorded traffic: write what the vehicles did (all of them, or only --ego) "
        "instead of what ego could do.",
    ),
    jobs: Jobs = shared.jobs_option("With --recorded: write the drives of N vehicles in parallel"),
    drives: DrivesOptions = drives_options,
) -> None:
    """Write every maneuver of SCENARIO (a name or a file) as a trace: JSON Lines, CSV or Parquet.

    With --recorded, write what the vehicles of recorded traffic did. `rulec verify` reads the file.
    It is written completely or not at all.
    """
    if recorded:
        file = Path(file_named(scenario))
        if (option := _given_maneuvers_option()) is not None:
            raise click.UsageError(f"{option} is for maneuvers, not for --recorded drives.")
        book = None if rulebook is None else read_machines(rulebook)
        vocabulary = None if book is None else book.vocabulary
        egos = () if cut.ego is None else (cut.ego,)
        wanted_drives = drives.requested(egos, vocabulary)
        _write_drives(cut.source(file), wanted_drives, book, to, jobs=jobs, first=first)
        return
    option = next(as_typed(drives), None)
    context = click.get_current_context()
    if option is None and shared.is_from(context, "jobs", ParameterSource.COMMANDLINE):
        option = "-j"
    if option:
        raise click.UsageError(f"{option} is for drives: add --recorded.")
    scene = cut.scene(scenario)
    rules = None if rulebook is None else read_machines(rulebook)
    with contained("no answer", SourceLocation(scenario)):
        if rules is None:
            graph = rulec.navigation_graph(scene, **cut.cells("paper")).trace_graph()
        else:
            graph = rulec.find_maneuvers(scene, rules, **cut.cells()).paths
        total = lazy.count_paths(graph)
    if first is None and total > MOST_TRACES:
        raise click.UsageError(
            f"There are {shown_count(total)} traces; that would fill a disk. "
            "Name how many to write with --first N, or count them with `rulec maneuvers`."
        )
    wanted = total if first is None else min(first, total)
    with progress(f"writing {to.path}", wanted) as tell:
        traces = _counted_aloud(all_traces(graph, scene.name, wanted), tell)
        kinds = lazy.kinds_in(chain.from_iterable(graph.states))
        partial = graph.told is not None or bool(partial_names(chain.from_iterable(graph.states)))
        with output_stream(to) as (stream, name):
            lazy.trace_files.write_traces(
                traces, stream, name, cast("lazy.Format", to.form), kinds, partial=partial
            )
    print_written(f"{wanted:,} of {shown_count(total)} traces to {to.path}", to)


_OF_MANEUVERS = {one.name for one in fields(SceneOptions)} - {"ego"}
_OF_MANEUVERS -= {one.name for one in fields(RecordingOptions)}
"""The options that have no meaning for drives."""


def _write_drives(
    source: lazy.RecordingSource,
    wanted: lazy.RequestedDrives,
    book: lazy.CompiledRulebook | None,
    to: Output,
    *,
    jobs: Jobs,
    first: int | None,
) -> None:
    drives = lazy.WrittenDrives(
        source,
        wanted,
        None if book is None else book.vocabulary,
        "" if book is None else book.traffic,
        cast("lazy.Format", to.form),
    )
    vehicles, kinds = drives.selected.egos, drives.kinds
    count = 0

    def counted(pieces: Iterable[Piece]) -> Iterator[Piece]:
        nonlocal count
        for piece in islice(pieces, first):
            count += 1
            yield piece

    lost = partial(print_lost, "wrote the drives of")
    with (
        progress(f"writing {to.path}", len(vehicles)) as tell,
        output_stream(to) as (stream, name),
    ):
        if to.form == "parquet":
            # In Parquet the rows of a vehicle have to be contiguous.
            with closing(lazy.in_vehicle_order(drives.traces, drives, jobs, tell, lost)) as traces:
                lazy.trace_files.write_traces(
                    counted(traces), stream, name, "parquet", kinds, partial=True
                )
        else:
            stream.write(drives.head)
            with closing(lazy.in_vehicle_order(drives.written, drives, jobs, tell, lost)) as pieces:
                for piece in counted(pieces):
                    stream.write(piece)
    print_written(f"{count:,} drives to {to.path}", to)


def _given_maneuvers_option() -> str | None:
    """A given option, if any, that has no meaning for recorded drives."""
    context = click.get_current_context()
    return next(
        (
            parameter.opts[0]
            for parameter in context.command.params
            if parameter.name in _OF_MANEUVERS
            and shared.is_from(context, parameter.name, ParameterSource.COMMANDLINE)
        ),
        None,
    )


def _counted_aloud(items: Iterable[Piece], tell: Callable[[float], None]) -> Iterator[Piece]:
    for number, item in enumerate(items):
        if number % _ALOUD == 0:
            tell(number)
        yield item
