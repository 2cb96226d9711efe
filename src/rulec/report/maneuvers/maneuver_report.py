"""Text report of counts of maneuvers and of further answers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.monitoring.verdict import Violation
from rulec.planning import Maneuvers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.maneuvers import (
    homotopy_classes,
    probabilities,
    pruning_table,
    ranked_maneuvers,
    scene_notes,
)
from rulec.report.maneuvers.maneuver_answers import ManeuverAnswers, horizon_s
from rulec.report.maneuvers.maneuver_lines import cell_lines, in_a_line
from rulec.report.text.count_text import shown_count
from rulec.report.text.terminal_text import styled, visible

MOST_VIOLATIONS = 6
"""So many of the past's are named in text; JSON has them all."""

MOST_DEFAULTS = 4
"""So many of what has its default are named in text; JSON has them all."""


def as_text(maneuvers: Maneuvers, answers: ManeuverAnswers, seconds: float) -> str:
    """Write the counts, and a block for each maneuver asked for."""
    graph, rules = maneuvers.graph, maneuvers.rules
    names = ", ".join(rule.name for rule in rules.rules if rule.strength == "hard")
    by = f"{rules.name} ({names or 'no hard rules'})" if len(names) <= 60 else rules.name
    horizon = f"{horizon_s(graph):g} s in steps of {graph.step_s:g} s"
    how = f"partition {graph.partition}, adjacency {graph.adjacency}"
    how += f", extent {graph.extent}" if graph.extent != "lane" else ""
    lines = [
        f"scenario    {graph.scenario.name}: {horizon}, {how}",
        *_scene(maneuvers),
        f"graph       {graph.nodes:,} nodes, {graph.edges:,} edges",
        f"maneuvers   {shown_count(maneuvers.traces)}",
        f"satisfying  {styled(shown_count(maneuvers.satisfying), 'bold')} by {by}",
        *_violated_before(maneuvers.violated_before or ()),
        *_by_default(maneuvers.by_default),
        *probabilities.summary(graph.scenario),
        *probabilities.world_lines(answers.worlds or ()),
    ]
    if answers.classes is not None:
        lines += homotopy_classes.count_lines(maneuvers, answers.classes[0])
    lines.append(f"computed in {seconds:.3f} s")
    for number, maneuver in enumerate(answers.listed or (), 1):
        lines += ["", f"{number}. {in_a_line(maneuver)}", *cell_lines(graph, maneuver)]
        lines += _chance_lines(answers, maneuver)
    if answers.best:
        lines += ["", "Every maneuver violates a hard rule. No other violates less than:"]
    for ranked_maneuver in (*(answers.best or ()), *(answers.ranked or ())):
        lines += ranked_maneuvers.blocks(maneuvers, [ranked_maneuver])
        lines += _chance_lines(answers, ranked_maneuver.maneuver)
    if answers.prunings is not None:
        lines += ["", *pruning_table.table(maneuvers, answers.prunings)]
    if answers.classes is not None:
        lines += homotopy_classes.blocks(maneuvers, answers.classes[1])
    return "\n".join(lines)


def _chance_lines(answers: ManeuverAnswers, maneuver: Maneuver) -> list[str]:
    told = answers.chances.get(maneuver.nodes)
    return [] if told is None else probabilities.lines(told)


def _scene(maneuvers: Maneuvers) -> Iterator[str]:
    account = maneuvers.graph.scenario.account
    return iter(()) if account is None else scene_notes.lines(maneuvers, account)


def _violated_before(violations: Sequence[Violation]) -> Iterator[str]:
    """A line for each rule already violated by the past."""
    for violation in violations[:MOST_VIOLATIONS]:
        where = ", ".join(f"{name} = {item}" for name, item in violation.binding.items())
        about = f" for {where}" if where else ""
        yield visible(f"violated    {violation.rule}{about}, before, and not counted any more")
    if len(violations) > MOST_VIOLATIONS:
        yield f"            and {len(violations) - MOST_VIOLATIONS:,} more; --json has them all"


def _by_default(names: Sequence[str]) -> Iterator[str]:
    """A line for the inputs without information, taken at their defaults."""
    if not names:
        return
    shown = ", ".join(names[:MOST_DEFAULTS])
    more = f" and {len(names) - MOST_DEFAULTS:,} more" if len(names) > MOST_DEFAULTS else ""
    yield visible(f"by default  {shown}{more}: the scenario does not say")
