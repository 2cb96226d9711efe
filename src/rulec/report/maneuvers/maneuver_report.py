"""What the search for maneuvers found, as text and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import click

from rulec.monitoring.verdict import Violation
from rulec.partition import NavigationGraph
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.probability.alternative_predictions import AlternativeCounts
from rulec.planning.probability.rule_probability import RuleProbabilities
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant
from rulec.report.findings.source_excerpt import visible
from rulec.report.maneuvers import (
    homotopy_classes,
    probabilities,
    pruning_table,
    ranked_maneuvers,
    scene_notes,
)
from rulec.report.maneuvers.maneuver_lines import as_data, cell_lines, in_a_line
from rulec.report.text.count_text import shown_count

MOST_VIOLATIONS = 6
"""So many of the past's are named in text; JSON has them all."""

MOST_DEFAULTS = 4
"""So many of what has its default are named in text; JSON has them all."""


@dataclass(frozen=True, slots=True)
class ManeuverAnswers:
    """What was asked for beside the counts; None is what was not.

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


def as_json(found: Maneuvers, answers: ManeuverAnswers, seconds: float) -> str:
    """The counts and what was asked for; maneuvers with cells, cost, margin and envelope."""
    graph = found.graph
    data: dict[str, Any] = {
        "scenario": graph.scenario.name,
        "rulebook": found.rules.name,
        "partition": graph.partition,
        "adjacency": graph.adjacency,
        "extent": graph.extent,
        "step_s": graph.step_s,
        "horizon_s": _horizon_s(graph),
        "nodes": graph.nodes,
        "edges": graph.edges,
        "traces": found.traces,
        "satisfying": found.satisfying,
        "by_default": list(found.by_default),
        "seconds": round(seconds, 6),
    }
    if graph.scenario.account is not None:
        data["scene"] = scene_notes.as_data(found, graph.scenario.account)
    if found.violated_before is not None:
        data["violated_before"] = [
            {"rule": one.rule, "binding": dict(one.binding), "step": one.step}
            for one in found.violated_before
        ]
    for key, ranked in (("least_violating", answers.best), ("ranked", answers.ranked)):
        if ranked is not None:
            data[key] = [
                {**ranked_maneuvers.as_data(found, one), **_chances(answers, one.maneuver)}
                for one in ranked
            ]
    if answers.listed is not None:
        data["maneuvers"] = [
            {**as_data(graph, one), **_chances(answers, one)} for one in answers.listed
        ]
    if any(one.alternatives for one in graph.scenario.obstacles):
        data["likeliest"] = probabilities.likeliest(graph.scenario)
    if answers.worlds is not None:
        data["worlds"] = probabilities.worlds_as_data(answers.worlds)
    if answers.prunings is not None:
        data["rules"] = [pruning_table.as_data(found, one) for one in answers.prunings]
    if answers.classes is not None:
        data["classes"] = homotopy_classes.as_data(found, *answers.classes)
    return json.dumps(data, ensure_ascii=False)


def as_text(found: Maneuvers, answers: ManeuverAnswers, seconds: float) -> str:
    """The counts in a few lines, and a block for every maneuver that was asked for."""
    graph, rules = found.graph, found.rules
    names = ", ".join(rule.name for rule in rules.rules if rule.strength == "hard")
    by = f"{rules.name} ({names or 'no hard rules'})" if len(names) <= 60 else rules.name
    horizon = f"{_horizon_s(graph):g} s in steps of {graph.step_s:g} s"
    how = f"partition {graph.partition}, adjacency {graph.adjacency}"
    how += f", extent {graph.extent}" if graph.extent != "lane" else ""
    lines = [
        f"scenario    {graph.scenario.name}: {horizon}, {how}",
        *_scene(found),
        f"graph       {graph.nodes:,} nodes, {graph.edges:,} edges",
        f"maneuvers   {shown_count(found.traces)}",
        f"satisfying  {click.style(shown_count(found.satisfying), bold=True)} by {by}",
        *_violated_before(found.violated_before or ()),
        *_by_default(found.by_default),
        *probabilities.summary(graph.scenario),
        *probabilities.world_lines(answers.worlds or ()),
    ]
    if answers.classes is not None:
        lines += homotopy_classes.count_lines(found, answers.classes[0])
    lines.append(f"computed in {seconds:.3f} s")
    for number, maneuver in enumerate(answers.listed or (), 1):
        lines += ["", f"{number}. {in_a_line(maneuver)}", *cell_lines(graph, maneuver)]
        lines += _chance_lines(answers, maneuver)
    if answers.best:
        lines += ["", "Every maneuver violates a hard rule. No other violates less than:"]
    for one in (*(answers.best or ()), *(answers.ranked or ())):
        lines += ranked_maneuvers.blocks(found, [one])
        lines += _chance_lines(answers, one.maneuver)
    if answers.prunings is not None:
        lines += ["", *pruning_table.table(found, answers.prunings)]
    if answers.classes is not None:
        lines += homotopy_classes.blocks(found, answers.classes[1])
    return "\n".join(lines)


def _chances(answers: ManeuverAnswers, maneuver: Maneuver) -> dict[str, Any]:
    told = answers.chances.get(maneuver.nodes)
    return {} if told is None else {"chances": probabilities.as_data(told)}


def _chance_lines(answers: ManeuverAnswers, maneuver: Maneuver) -> list[str]:
    told = answers.chances.get(maneuver.nodes)
    return [] if told is None else probabilities.lines(told)


def _scene(found: Maneuvers) -> Iterator[str]:
    account = found.graph.scenario.account
    return iter(()) if account is None else scene_notes.lines(found, account)


def _violated_before(violations: Sequence[Violation]) -> Iterator[str]:
    """A line for each rule that the past has violated, which no maneuver can mend."""
    for one in violations[:MOST_VIOLATIONS]:
        where = ", ".join(f"{name} = {item}" for name, item in one.binding.items())
        about = f" for {where}" if where else ""
        yield visible(f"violated    {one.rule}{about}, before, and not counted any more")
    if len(violations) > MOST_VIOLATIONS:
        yield f"            and {len(violations) - MOST_VIOLATIONS:,} more; --json has them all"


def _by_default(names: Sequence[str]) -> Iterator[str]:
    """A line for what nobody has said, so that it was taken to be as usual."""
    if not names:
        return
    shown = ", ".join(names[:MOST_DEFAULTS])
    more = f" and {len(names) - MOST_DEFAULTS:,} more" if len(names) > MOST_DEFAULTS else ""
    yield visible(f"by default  {shown}{more}: the scenario does not say")


def _horizon_s(graph: NavigationGraph) -> float:
    return float((len(graph.layers) - 1) * graph.step)
