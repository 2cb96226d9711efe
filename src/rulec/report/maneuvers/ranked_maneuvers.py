"""Maneuvers ranked by what they violate, as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from rulec.logic.printing import number_in_words
from rulec.monitoring.verdict import Violation
from rulec.planning import Maneuvers, RankedManeuver
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.report.maneuvers import maneuver_lines
from rulec.report.text.count_text import shown_count
from rulec.report.text.terminal_text import visible

MOST_VIOLATIONS = 20
"""So many are shown for a maneuver; JSON has them all."""


def blocks(maneuvers: Maneuvers, ranked: Sequence[RankedManeuver]) -> list[str]:
    """A block for each: its place, what it violates, its cells."""
    lines = []
    for ranked_maneuver in ranked:
        others = (
            f"; {shown_count(ranked_maneuver.members)} violate the same"
            if ranked_maneuver.members > 1
            else ""
        )
        lines += [
            "",
            (
                f"{ranked_maneuver.place}. "
                f"{maneuver_lines.in_a_line(ranked_maneuver.maneuver)}{others}"
            ),
        ]
        lines.append(f"   violates {_penalty(ranked_maneuver.penalty)}")
        lines += [
            f"     {violation_line(maneuvers, v)}"
            for v in ranked_maneuver.violations[:MOST_VIOLATIONS]
        ]
        if len(ranked_maneuver.violations) > MOST_VIOLATIONS:
            lines.append(f"     and {len(ranked_maneuver.violations) - MOST_VIOLATIONS} more")
        lines += maneuver_lines.cell_lines(maneuvers.graph, ranked_maneuver.maneuver)
    return lines


def violation_line(maneuvers: Maneuvers, violation: Violation) -> str:
    """The violated rule with its article, its binding and its time."""
    rule = next(rule for rule in maneuvers.rules.rules if rule.name == violation.rule)
    cite = f" [{rule.cite}]" if rule.cite else ""
    objects = ", ".join(f"{name} = {visible(value)}" for name, value in violation.binding.items())
    bound = f" for {objects}" if objects else ""
    return f"{rule.strength} rule {rule.name}{cite}{bound}: {when_lost(maneuvers, violation)}"


def when_lost(maneuvers: Maneuvers, violation: Violation) -> str:
    """The time from which the rule cannot be kept any more."""
    if violation.step is None:
        return "by how it ends"
    return f"cannot be kept any more from {maneuvers.graph.layers[violation.step].start_s:g} s on"


def _penalty(penalty: Mapping[PenaltyRank, Fraction]) -> str:
    if not penalty:
        return "no rule"
    return ", ".join(
        f"{rank.strength} {_levels(rank)} {number_in_words(weight)}"
        for rank, weight in penalty.items()
    )


def _levels(rank: PenaltyRank) -> str:
    return " = ".join(level or "(no level)" for level in rank.levels)
