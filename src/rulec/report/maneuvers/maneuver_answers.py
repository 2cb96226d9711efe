"""The answers to what is asked about the maneuvers of a scenario."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import prod
from typing import Any

from rulec.partition import NavigationGraph
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.probability.rule_probability import AlternativeCounts, RuleProbabilities
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant
from rulec.scenario import Account, Scenario


@dataclass(frozen=True, slots=True)
class ManeuverAnswers:
    """Answers to further questions about maneuvers, None where not asked.

    ``best`` are the least violating maneuvers, where none satisfies every hard rule and there is no
    longer list of them in ``ranked``. ``chances`` are those of maneuvers, given by their nodes.
    """

    listed: Sequence[Maneuver] | None = None
    best: Sequence[RankedManeuver] | None = None
    ranked: Sequence[RankedManeuver] | None = None
    prunings: Sequence[RulePruning] | None = None
    classes: tuple[HomotopyClasses, Sequence[Variant]] | None = None
    chances: Mapping[tuple[int, ...], RuleProbabilities] = field(default_factory=dict)
    worlds: Sequence[AlternativeCounts] | None = None


def horizon_s(graph: NavigationGraph) -> float:
    """Time from the first layer's start to the last one's, in seconds."""
    return float((len(graph.layers) - 1) * graph.step)


def likeliest(scenario: Scenario) -> float:
    """The probability that all obstacles do what is likeliest."""
    return float(prod((obstacle.weight for obstacle in scenario.obstacles), start=Fraction(1)))


def derived_signals(maneuvers: Maneuvers, account: Account) -> dict[str, tuple[Any, str]]:
    """Signals supplied by the recording, each with value and reason."""
    supplied = maneuvers.paths.states[0][0]
    return {
        name: (supplied[name], because)
        for name, because in account.derived.items()
        if name in supplied
    }
