"""Table of rules by the number of maneuvers that they prune."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.planning import Maneuvers, RulePruning
from rulec.report.maneuvers import maneuver_lines
from rulec.report.maneuvers.ranked_maneuvers import when_lost
from rulec.report.text.count_text import shown_count
from rulec.report.text.terminal_text import table_lines

HEAD = ("rule", "violated by", "alone by", "for example")


def table(maneuvers: Maneuvers, prunings: Sequence[RulePruning]) -> list[str]:
    """A line for each rule that prunes maneuvers; names of the others."""
    rows = [HEAD, *(_row(maneuvers, pruning) for pruning in prunings if pruning.violating)]
    lines = table_lines(rows, right=(1, 2))
    idle = [pruning.rule.name for pruning in prunings if not pruning.violating]
    if idle:
        lines.append(f"violated by none: {', '.join(idle)}")
    return lines if len(rows) > 1 else lines[1:]


def _row(maneuvers: Maneuvers, pruning: RulePruning) -> tuple[str, str, str, str]:
    alone = "soft" if pruning.alone is None else shown_count(pruning.alone)
    return pruning.rule.name, shown_count(pruning.violating), alone, _example(maneuvers, pruning)


def _example(maneuvers: Maneuvers, pruning: RulePruning) -> str:
    assert pruning.example is not None, "something violates it"
    first = pruning.violations[0]
    moves = maneuver_lines.relations_in_time(
        maneuvers.graph, pruning.example, tuple(first.binding.values())
    )
    return f"{moves}; {when_lost(maneuvers, first)}"
