"""``rulec draw``: scenes, graphs, traces and recorded drives as pictures."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from itertools import islice
from typing import TypeAlias

import click

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import (
    Output,
    endings_of,
    input_format_option,
    output_options,
)
from rulec.cli.options.recording_options import (
    TRACE_FORMATS,
    DrivesOptions,
    RecordingOptions,
    drives_options,
    recording_options,
)
from rulec.cli.options.scenario_options import (
    ReadingOptions,
    SceneOptions,
    cell_options,
    reading_options,
    scenario_argument,
)
from rulec.cli.options.shared_options import refuse_unmatched, with_rules_like
from rulec.cli.options.standard_input import file_named
from rulec.cli.options.verb_class import VerbGroup, argument, asking, gathered, option
from rulec.cli.output import put_picture, read_machines
from rulec.diagnostics import RulecError, SourceLocation, named
from rulec.diagnostics.fault_messages import contained
from rulec.recordings.recording_files import read_recording
from rulec.report.pictures.drawing.styles import Theme
from rulec.report.text.terminal_text import shown_count
from rulec.trace import Trace

Judged: TypeAlias = "tuple[lazy.NavigationGraph, lazy.Maneuvers | None, lazy.Maneuver | None]"

_WHY_ONE = "a picture shows what one rulebook says"

_picture_options = output_options(
    endings_of("svg", "png", "pdf", "html"), "the picture", required=True, former=["--format"]
)


@dataclass(frozen=True, kw_only=True)
class JudgedScene:
    """A scenario as cells, and the rulebook that judges its maneuvers, if there is one."""

    scenario: str = scenario_argument
    cut: SceneOptions = cell_options
    rulebook: str | None = shared.rulebook_option(
        _WHY_ONE, shared.RULEBOOK_HELP + " Without it, nothing is judged.", required=False
    )
    number: int | None = shared.number_option(
        "--maneuver",
        "Show the N-th cheapest satisfying maneuver.  [default: 1 if there is a rulebook]",
        least=1,
    )
    missing: ReadingOptions = reading_options
    at: str = shared.at_option


@click.group(cls=VerbGroup, invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Draw a recorded drive, a scene over time, a navigation graph, or a trace.

    The picture is SVG, PNG, PDF or an HTML page. SVG and HTML need no further package and follow
    the reader's light or dark theme; PNG and PDF need the extra `pictures`: in a checkout
    `.venv/bin/python -m pip install -e '.[pictures]'`.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@command.command()
@asking
def trace(
    *,
    file: str = argument(),
    rulebook: str = shared.rulebook_option(_WHY_ONE),
    trace_id: str | None = option(
        "--trace", metavar="ID", help="Draw the trace with this id.  [default: the first]"
    ),
    patterns: tuple[str, ...] = shared.rules_option("Draw only what rules that match PATTERN read"),
    only: tuple[str, ...] = option(
        "--object",
        multiple=True,
        metavar="ID",
        help="Draw only this object. May be given several times.",
    ),
    every_row: bool = option(
        "--all", is_flag=True, help="Draw what any rule reads, not only the violated rules."
    ),
    input_format: lazy.Format | None = input_format_option(
        TRACE_FORMATS, "the traces.  [default: by the extension of FILE, else jsonl]"
    ),
    at: str = shared.at_option,
    to: Output = _picture_options,
) -> None:
    """Draw a trace of FILE (JSON Lines, CSV or Parquet): the values that violated rules read.

    If no rule is violated, the values that any rule reads are drawn. A violation is marked at the
    state where it is decided, with the rule and its article.
    """
    rules = read_machines(rulebook, at)
    drawn = _trace(file, trace_id, input_format)
    for item in only:
        if item not in drawn.objects:
            raise click.UsageError(
                f"trace `{drawn.id}` has no object `{item}`; it has {named(list(drawn.objects))}."
            )
    used = _only(lazy.rulebook_for_trace(drawn, rules), patterns)
    put_picture(lazy.trace_drawing(drawn, used, only, patterns, every_row=every_row), to)


@command.command()
@asking
def drive(
    *,
    file: str = argument(),
    rulebook: str = shared.rulebook_option(_WHY_ONE),
    ego: str = option(
        "--ego",
        default="",
        metavar="ID",
        help="The vehicle, or one of its drives such as 373#2.  [default: the first one to violate "
        "a rule]",
    ),
    patterns: tuple[str, ...] = shared.rules_option(
        "Show only violations of rules that match PATTERN"
    ),
    at_s: float | None = option(
        "--at-time",
        type=float,
        callback=shared.finite,
        metavar="S",
        help="The time to draw, in s of the recording.  [default: the first violation]",
    ),
    theme: Theme = option(
        "--theme",
        type=click.Choice(["auto", "light", "dark"]),
        default="auto",
        show_default=True,
        help="Light or dark; `auto` follows the reader's theme, and is light in PNG and PDF.",
    ),
    drives: DrivesOptions = drives_options,
    recorded: RecordingOptions = recording_options,
    at: str = shared.at_option,
    to: Output = _picture_options,
) -> None:
    """Draw a drive of the recording FILE from above: the road, all traffic, the violations.

    FILE is recorded traffic, in one of `rulec list formats`. A picture shows the moment of the
    first violation; an HTML page plays the whole drive and lists all violations.
    """
    rules = read_machines(rulebook, at)
    vehicle, part, _ = ego.partition("#")
    wanted = drives.requested((vehicle,) if vehicle else (), rules.vocabulary)
    kept = frozenset(rule.name for rule in _only(rules, patterns).rules) if patterns else None
    recording = read_recording(recorded.source(file_named(file)))
    verdicts = rulec.verify_recording(recording, rules, wanted)
    with contained("not drawn", SourceLocation(file)):
        drawing = lazy.drive_drawing(verdicts, ego if part else "", kept, at_s)
    put_picture(drawing, to, theme)


@command.command()
@asking
def scene(
    *,
    judged: JudgedScene = gathered(JudgedScene),
    layers: tuple[int, ...] = shared.number_option(
        "--layer",
        "Draw only layer P, counted from 0; may be given several times.  [default: all]",
        multiple=True,
        metavar="P",
    ),
    to: Output = _picture_options,
) -> None:
    """Draw SCENARIO (a name or a file) over time: cells with signatures, obstacles, a maneuver.

    With a rulebook, the cells of the cheapest satisfying maneuver are highlighted; their bounds are
    its envelope. An HTML page has a time slider.
    """
    graph, maneuvers, maneuver = _judged(judged)
    last = len(graph.layers) - 1
    if layers and max(layers) > last:
        raise click.UsageError(f"There is no layer {max(layers)}; they are 0 to {last}.")
    put_picture(lazy.scene_drawing(graph, maneuvers, maneuver, layers, judged.number or 1), to)


@command.command()
@asking
def graph(*, judged: JudgedScene = gathered(JudgedScene), to: Output = _picture_options) -> None:
    """Draw the navigation graph of SCENARIO (a name or a file), layer by layer.

    With a rulebook, the edges of satisfying maneuvers are drawn differently from those of rejected
    ones, and the cheapest satisfying maneuver is highlighted.
    """
    put_picture(lazy.graph_drawing(*_judged(judged)), to)


def _trace(file: str, trace_id: str | None, form: lazy.Format | None) -> Trace:
    names: list[str] = []
    for item in lazy.read_traces(file_named(file), form):
        if isinstance(item, RulecError):
            raise item
        if trace_id in (None, item.id):
            return item
        names.append(item.id)
    some = ", ".join(f"`{name}`" for name in names[:5]) + (", …" if len(names) > 5 else "")
    raise click.UsageError(f"`{file}` has no trace `{trace_id}`; it has {some}.")


def _only(rules: lazy.CompiledRulebook, patterns: tuple[str, ...]) -> lazy.CompiledRulebook:
    refuse_unmatched(patterns, [rules])
    return with_rules_like(rules, patterns)


def _judged(judged: JudgedScene) -> Judged:
    """The graph, its maneuvers if there is a rulebook, and the maneuver shown."""
    scenario, cut, missing, number = judged.scenario, judged.cut, judged.missing, judged.number
    if judged.rulebook is None:
        if number is not None:
            raise click.UsageError("`--maneuver` takes a rulebook: give one with `-r R`.")
        missing.reading(None)
        scene = cut.scene(scenario)
        with contained("not drawn", SourceLocation(scenario)):
            return rulec.navigation_graph(scene, **cut.cells("paper")), None, None
    rules = read_machines(judged.rulebook, judged.at)
    reading = missing.reading(rules.vocabulary)
    scene = cut.scene(scenario)
    with contained("not drawn", SourceLocation(scenario)):
        maneuvers = rulec.find_maneuvers(scene, rules, **reading, **cut.cells())
    place = number or 1
    maneuver = None
    legal = maneuvers.satisfying + maneuvers.open
    if place <= min(legal, sys.maxsize):
        # As in `maneuvers --list`: if ego's motion has bounds, only drivable maneuvers
        maneuver = next(islice(maneuvers.cheapest(place, perhaps=True), place - 1, None), None)
    if maneuver is None and number is not None:
        why = f"{shown_count(legal)} satisfy the rulebook{', or may' if maneuvers.open else ''}"
        if number <= legal:
            why += ", and fewer were found that ego can drive"
        raise click.UsageError(f"There is no maneuver {number}: {why}.")
    return maneuvers.graph, maneuvers, maneuver
