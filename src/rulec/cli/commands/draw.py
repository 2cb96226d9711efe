"""``rulec draw``: scenes, graphs and traces as pictures."""

from __future__ import annotations

import sys
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import rulec
from rulec.cli.commands.draw_trace import trace
from rulec.cli.options.picture_options import picture_options, write
from rulec.cli.options.scenario_options import graph_options, read_scene
from rulec.cli.options.shared_options import (
    RULEBOOK_HELP,
    at_option,
    combined,
    rulebook_option,
)
from rulec.cli.project import read_machines
from rulec.report.text.terminal_text import shown_count

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph
    from rulec.planning import Maneuvers
    from rulec.planning.ranking.cheapest import Maneuver

    Judged = tuple[NavigationGraph, Maneuvers | None, Maneuver | None]


_judging_options = combined(
    [
        rulebook_option(RULEBOOK_HELP + " Left out, nothing is judged.", required=False),
        click.option(
            "--maneuver",
            "number",
            type=click.IntRange(min=1),
            metavar="N",
            help="Show the N-th cheapest satisfying maneuver.  [default: 1 if there is a rulebook]",
        ),
        at_option,
    ]
)


@click.group()
def command() -> None:
    """Draw the scene over time, the navigation graph, or a trace: as SVG, PNG or a page (HTML).

    SVG and HTML need nothing else and come in light and dark, as the reader prefers; PNG takes
    `pip install 'rulec[pictures]'`.
    """


command.add_command(trace)


@command.command()
@graph_options
@_judging_options
@click.option(
    "--layer",
    "layers",
    multiple=True,
    type=click.IntRange(min=0),
    metavar="P",
    help="Draw layer P alone, counted from 0; may be repeated.  [default: all]",
)
@picture_options
def scene(layers: tuple[int, ...], output: Path, form: str | None, **options: Any) -> None:
    """Draw SCENARIO (a name or a file) over time: cells with signatures, obstacles, a maneuver.

    With a rulebook the cheapest maneuver that satisfies it is shown by its cells, whose bounds are
    its envelope. A page (HTML) has a slider for the time.
    """
    # Cells, maneuvers and pictures, 150 ms: not for --help.
    from rulec.api.pictures import scene_drawing

    graph, maneuvers, maneuver = _judged(**options)
    last = len(graph.layers) - 1
    if layers and max(layers) > last:
        raise click.UsageError(f"There is no layer {max(layers)}; they are 0 to {last}.")
    number = options["number"] or 1
    write(scene_drawing(graph, maneuvers, maneuver, layers, number), output, form)


@command.command()
@graph_options
@_judging_options
@picture_options
def graph(output: Path, form: str | None, **options: Any) -> None:
    """Draw the navigation graph of SCENARIO (a name or a file), layer by layer.

    With a rulebook the steps of satisfying maneuvers are told from those of rejected ones, and the
    cheapest satisfying maneuver is shown.
    """
    # As for ``scene``.
    from rulec.api.pictures import graph_drawing

    write(graph_drawing(*_judged(**options)), output, form)


def _judged(
    scenario: str, rulebook: str | None, number: int | None, at: str, **options: Any
) -> Judged:
    """The graph, with a rulebook its maneuvers, and the one shown."""
    # Maneuvers, 110 ms: not for --help.
    from rulec.planning.ranking.cheapest import cheapest

    if rulebook is None:
        if number is not None:
            raise click.UsageError("`--maneuver` takes a rulebook: give one with `-r R`.")
        scene = read_scene(scenario, options)
        options["partition"] = options["partition"] or "paper"
        return rulec.navigation_graph(scene, **options), None, None
    rules = read_machines(rulebook, at)
    maneuvers = rulec.find_maneuvers(read_scene(scenario, options), rules, **options)
    wanted = number or 1
    maneuver = None
    if wanted <= min(maneuvers.satisfying, sys.maxsize):
        maneuver = next(islice(cheapest(maneuvers.product), wanted - 1, None))
    if maneuver is None and number is not None:
        raise click.UsageError(
            f"There is no maneuver {number}: "
            f"{shown_count(maneuvers.satisfying)} satisfy the rulebook."
        )
    return maneuvers.graph, maneuvers, maneuver
