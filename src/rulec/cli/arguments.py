"""Arguments that several verbs share, with the same words everywhere."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

RULEBOOK_HELP = "A rulebook: its name, its source (.rules) or a compiled one (.json)."


def rulebook_option(function: Decorated) -> Decorated:
    """``--rulebook R``, required."""
    option = click.option("-r", "--rulebook", required=True, metavar="R", help=RULEBOOK_HELP)
    return option(function)


def json_option(function: Decorated) -> Decorated:
    """``--json``: output for machines."""
    return click.option("--json", "json_output", is_flag=True, help="Print JSON.")(function)


def graph_options(function: Decorated) -> Decorated:
    """The scenario, and how it is cut into cells: step, horizon, partition, adjacency."""
    for decorate in (
        click.option(
            "--adjacency",
            type=click.Choice(["touch", "edge", "forward"]),
            default="touch",
            show_default=True,
            help="Which cells are neighbours: those that meet in a point, along a border, "
            "or along a border and not only behind.",
        ),
        click.option(
            "--partition",
            type=click.Choice(["paper", "fine"]),
            help="Four regions around an obstacle, or eight.  [default: what the rulebook reads; "
            "paper without one]",
        ),
        click.option(
            "--horizon", "horizon_s", type=float, metavar="T", help="How far to look ahead, in s."
        ),
        click.option(
            "--step", "step_s", type=float, metavar="S", help="The planning interval, in s."
        ),
        click.argument("scenario"),
    ):
        function = decorate(function)
    return function
