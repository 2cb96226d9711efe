"""Options for a scenario: its partition into cells, and what is chosen from a recorded scene."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Any

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.recording_options import RecordingOptions, assumptions
from rulec.cli.options.shared_options import finite
from rulec.cli.options.shell_completion import complete_scenarios
from rulec.cli.options.standard_input import file_named
from rulec.cli.options.verb_class import argument, gathered, option
from rulec.vocabulary import Vocabulary

_CELLS = ("step_s", "horizon_s", "extent", "adjacency", "bounds")
_WEIGHT = re.compile(r"[01]|0?\.[0-9]{1,9}")


def _prediction(
    context: click.Context, parameter: click.Parameter, value: str
) -> str | dict[str, Fraction]:
    known = " or ".join(f"`{kind}`" for kind in lazy.PREDICTIONS)
    if value in lazy.PREDICTIONS:
        return value
    fractions: dict[str, Fraction] = {}
    for part in value.split(","):
        kind, _, weight = (piece.strip() for piece in part.partition("="))
        if kind not in lazy.PREDICTIONS or kind in fractions:
            raise click.BadParameter(f"it has to be {known}, or each of them once with a weight")
        fractions[kind] = Fraction(weight) if _WEIGHT.fullmatch(weight) else Fraction(0)
        if not fractions[kind]:
            raise click.BadParameter(f"`{part}` has to end in a weight above 0, such as `=0.7`")
    if not lazy.is_distribution(sum(fractions.values(), Fraction(0))):
        raise click.BadParameter("the weights have to add up to 1")
    return fractions


@dataclass(frozen=True, kw_only=True)
class SceneOptions(RecordingOptions):
    """How a scenario is cut into cells, and what is chosen from a recorded one."""

    step_s: float | None = option(
        "--step",
        type=float,
        metavar="S",
        help="The planning interval, in s.",
    )
    horizon_s: float | None = option(
        "--horizon",
        type=float,
        metavar="T",
        help="The planning horizon, in s.",
    )
    partition: str | None = option(
        "--partition",
        type=click.Choice(["paper", "fine"]),
        help="Divide the space around an obstacle into four regions (paper) or eight (fine).  "
        "[default: what the rulebook needs; paper without a rulebook]",
    )
    extent: str | None = option(
        "--extent",
        type=click.Choice(["lane", "clearance", "body"]),
        help="How much space an obstacle occupies across the road: `lane` is every lane it "
        "touches; `clearance` is the same, except where ego fits beside it within a lane; "
        "`body` is the area its body sweeps plus half of ego's width on either side.  "
        "[default: clearance in a recorded scene with bounds, else lane]",
    )
    adjacency: str = option(
        "--adjacency",
        type=click.Choice(["touch", "edge", "forward"]),
        default="touch",
        show_default=True,
        help="Which cells are neighbours: those that touch, even in a single point; those that "
        "share an edge; or those that share an edge and do not lie only behind.",
    )
    bounds: str | None = option(
        "--bounds",
        metavar="BOUNDS",
        help="Keep only maneuvers that ego can drive within these motion bounds: a vehicle "
        "type, as in `truck`, numbers, as in `braking=6,acceleration=3`, or both; `none` keeps "
        "all paths through cells.  [default: the scenario's own; in recorded scenes those of "
        "ego's vehicle type]",
    )
    ego: str | None = option(
        "--ego",
        metavar="ID",
        help="Recorded scenes: the vehicle or planning problem to take as ego.  [default: the "
        "first planning problem]",
    )
    at_s: float | None = option(
        "--at-time",
        type=float,
        callback=finite,
        metavar="S",
        help="Recorded scenes: the time to start from, in s.  [default: that of the planning "
        "problem, or when the vehicle first appears]",
    )
    reference: str | None = option(
        "--reference",
        metavar="LANELET",
        help="Recorded scenes: the lanelet whose centre line is the reference line along the "
        "road.  [default: the one ego is on]",
    )
    prediction: str | Mapping[str, Fraction] = option(
        "--prediction",
        callback=_prediction,
        default="recorded",
        show_default=True,
        metavar="KIND",
        help="Recorded scenes: other traffic moves as `recorded`, or with `constant` "
        "acceleration, or either with a probability, as in `recorded=0.7,constant=0.3`.",
    )
    ego_width_m: float | None = option(
        "--ego-width",
        type=click.FloatRange(min=0, max=100),
        callback=finite,
        metavar="M",
        help="Recorded scenes: ego's width in m, used with `--extent clearance` and `body`.  "
        "[default: the width of the recorded vehicle, if ego is one; else the one in its "
        "bounds with `clearance`, and a point with `body`]",
    )
    congested_below_kmh: float = option(
        "--congested-below",
        type=click.FloatRange(min=0),
        callback=finite,
        default=30.0,
        show_default=True,
        metavar="KMH",
        help="Recorded scenes: below this median speed traffic counts as congested.",
    )

    def scene(self, scenario: str) -> lazy.Scenario:
        """Load the scenario. Raises RulecError."""
        choice = lazy.Choice(**{one.name: getattr(self, one.name) for one in fields(lazy.Choice)})
        return lazy.load_scenario(file_named(scenario), choice)

    def cells(self, partition: str | None = None) -> dict[str, Any]:
        """Keyword arguments of ``find_maneuvers``; ``partition`` is the default one."""
        return {name: getattr(self, name) for name in _CELLS} | {
            "partition": self.partition or partition
        }


@dataclass(frozen=True, kw_only=True)
class ReadingOptions:
    """What is assumed where a scenario says nothing."""

    assumed: tuple[str, ...] = option(
        "--assume",
        multiple=True,
        metavar="NAME=VALUE",
        help="A value to assume wherever the scenario does not provide one, such as "
        "built_up=true; or `defaults`, which gives unknown values their default.",
    )
    told_only: bool = option(
        "--told-only",
        is_flag=True,
        help="Treat values that the scenario does not mention as unknown instead of giving "
        "them their default.",
    )

    def reading(self, vocabulary: Vocabulary | None) -> dict[str, Any]:
        """Keyword arguments of ``find_maneuvers``.

        Raises:
            click.UsageError: an assumption is invalid, contradicts another, or lacks a rulebook.
        """
        if self.told_only and "defaults" in self.assumed:
            raise click.UsageError(
                "--told-only and --assume defaults say the opposite of each other."
            )
        if not self.assumed and not self.told_only:
            return {}
        if vocabulary is None:
            option = "--assume" if self.assumed else "--told-only"
            raise click.UsageError(f"{option} needs a rulebook that has the words: --rulebook R")
        assumed = assumptions(None, self.assumed, vocabulary)
        return {"assumptions": assumed, "told_only": self.told_only}


cell_options = gathered(SceneOptions)

scenario_argument = argument(shell_complete=complete_scenarios)

scenarios_argument = argument(
    nargs=-1, required=True, metavar="SCENARIO...", shell_complete=complete_scenarios
)

reading_options = gathered(ReadingOptions)
