"""Titles of pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rulec.report.text.count_text import shown_count

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.monitoring.verdict import Verdict
    from rulec.partition import NavigationGraph
    from rulec.planning import Maneuvers
    from rulec.planning.ranking.cheapest import Maneuver


def scene_title(
    graph: NavigationGraph, maneuvers: Maneuvers | None, maneuver: Maneuver | None, number: int
) -> str:
    """The scenario, and which maneuver is shown."""
    name = graph.scenario.name
    if maneuvers is None:
        return f"{name}: {graph.nodes:,} cells in {len(graph.layers)} layers"
    by = f"of {shown_count(maneuvers.satisfying)} that satisfy {maneuvers.rules.name}"
    if maneuver is None:
        return f"{name}: no maneuver satisfies {maneuvers.rules.name}"
    margin = "" if maneuver.margin_s is None else f", margin {maneuver.margin_s:g} s"
    return f"{name}: maneuver {number} {by}; cost {maneuver.cost:.4g} 1/s{margin}"


def graph_title(graph: NavigationGraph, found: Maneuvers | None, maneuvers: int) -> str:
    """The scenario, the size of its graph, and the number of maneuvers."""
    counts = f"{graph.scenario.name}: {graph.nodes:,} nodes, {graph.edges:,} edges"
    if found is None:
        return f"{counts}, {shown_count(maneuvers)} maneuvers"
    satisfying = f"{shown_count(maneuvers)} satisfying by {found.rules.name}"
    return f"{counts}, {shown_count(found.traces)} maneuvers, {satisfying}"


def trace_title(verdict: Verdict, rules: CompiledRulebook, only: Sequence[str] = ()) -> str:
    """The trace and its verdict, ``only`` of some rules and objects."""
    number = len(verdict.violations)
    words = "no violation" if not number else "1 violation" if number == 1 else None
    return f"{verdict.trace}: {words or f'{number:,} violations'} by {rules.name}" + (
        f", only {', '.join(only)}" if only else ""
    )
