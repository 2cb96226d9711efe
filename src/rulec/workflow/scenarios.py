"""From a scenario to its graph of traces, and to the maneuvers that satisfy a rulebook."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rulec.automata.compiled import CompiledRulebook
from rulec.maneuvers import Maneuvers, judged, partition_for
from rulec.workflow.rulebooks import machines

if TYPE_CHECKING:
    from rulec.automata.any_step import AnyStep
    from rulec.partition import AdjacencyName, ExtentName, NavigationGraph, PartitionName
    from rulec.rulebook.model import Rulebook
    from rulec.runtime.before import Before
    from rulec.scenario import Scenario


def navigation_graph(
    scenario: str | Path | Scenario,
    *,
    partition: PartitionName = "paper",
    adjacency: AdjacencyName = "touch",
    extent: ExtentName = "lane",
    step_s: float | None = None,
    horizon_s: float | None = None,
) -> NavigationGraph:
    """Partition a scenario, given by name, by path or itself, into cells and their graph.

    In a recorded scene the step, unless given, is the longest one that leaves ego a place to start.
    """
    from rulec.partition import navigation_graph as build
    from rulec.scenario import Scenario, load_scenario

    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario)
    if step_s is None and scenario.account is not None:
        step_s = _longest_step(scenario, partition, extent, horizon_s)
    return build(
        scenario,
        partition=partition,
        adjacency=adjacency,
        extent=extent,
        step_s=step_s,
        horizon_s=horizon_s,
    )


def _longest_step(
    scenario: Scenario, partition: PartitionName, extent: ExtentName, horizon_s: float | None
) -> float | None:
    """The scenario's own step, or the half of it, and so on; None if none will do."""
    from rulec.partition.start import step_that_leaves_room
    from rulec.scenario.timing import timing

    times = timing(scenario.horizon_s if horizon_s is None else horizon_s, scenario.step_s)
    found = step_that_leaves_room(scenario, times, partition, extent)
    return None if found is None else float(found.step)


def find_maneuvers(
    scenario: str | Path | Scenario,
    rulebook: str | Path | Rulebook | CompiledRulebook | AnyStep,
    *,
    partition: PartitionName | None = None,
    adjacency: AdjacencyName = "touch",
    extent: ExtentName = "lane",
    step_s: float | None = None,
    horizon_s: float | None = None,
    after: Before | None = None,
) -> Maneuvers:
    """Algorithm 1 of the paper, counting instead of enumerating.

    ``partition``: the one whose relations the rulebook reads, unless given. ``after``: what was
    before, up to one step before the scenario begins: a trace, a ``Monitor`` that has taken one, or
    its snapshot. Raises RulecError.
    """
    rules = machines(rulebook)
    source = rules if isinstance(rules, CompiledRulebook) else rules.rulebook
    graph = navigation_graph(
        scenario,
        partition=partition_for(source, partition),
        adjacency=adjacency,
        extent=extent,
        step_s=step_s,
        horizon_s=horizon_s,
    )
    compiled = rules if isinstance(rules, CompiledRulebook) else rules(graph.step)
    return judged(graph, compiled, after)
