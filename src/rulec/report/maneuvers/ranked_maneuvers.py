"""Maneuvers ranked by what they violate, as text and as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.logic.printing import number_in_words
from rulec.monitoring.verdict import Violation
from rulec.planning import Maneuvers, RankedManeuver
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.report.findings.source_excerpt import visible
from rulec.report.maneuvers import maneuver_lines
from rulec.report.text.count_text import shown_count

MOST_VIOLATIONS = 20
"""So many are shown for a maneuver; JSON has them all."""


def as_data(found: Maneuvers, ranked: RankedManeuver) -> dict[str, Any]:
    """The maneuver with its place, penalty and violations."""
    rules = {rule.name: rule for rule in found.rules.rules}
    return {
        "place": ranked.place,
        "penalty": [
            {
                "strength": rank.strength,
                "levels": [level or None for level in rank.levels],
                "weight": _plain(weight),
            }
            for rank, weight in ranked.penalty.items()
        ],
        "members": ranked.members,
        "violations": [violation_as_data(found, one, rules[one.rule]) for one in ranked.violations],
        **maneuver_lines.as_data(found.graph, ranked.maneuver),
    }


def violation_as_data(found: Maneuvers, one: Violation, rule: CompiledRule) -> dict[str, Any]:
    """A violation; ``lost_s`` is when the cell begins that violates the rule for good."""
    return {
        "rule": one.rule,
        "cite": rule.cite,
        "binding": dict(one.binding),
        "lost_s": None if one.step is None else found.graph.layers[one.step].start_s,
        "strength": one.strength,
        "level": rule.level or None,
        "weight": _plain(rule.weight),
    }


def blocks(found: Maneuvers, ranked: Sequence[RankedManeuver]) -> list[str]:
    """A block for each: its place, what it violates, its cells."""
    lines = []
    for one in ranked:
        others = f"; {shown_count(one.members)} violate the same" if one.members > 1 else ""
        lines += ["", f"{one.place}. {maneuver_lines.in_a_line(one.maneuver)}{others}"]
        lines.append(f"   violates {_penalty(one.penalty)}")
        lines += [f"     {violation_line(found, v)}" for v in one.violations[:MOST_VIOLATIONS]]
        if len(one.violations) > MOST_VIOLATIONS:
            lines.append(f"     and {len(one.violations) - MOST_VIOLATIONS} more")
        lines += maneuver_lines.cell_lines(found.graph, one.maneuver)
    return lines


def violation_line(found: Maneuvers, violation: Violation) -> str:
    """Which rule, of which article, for whom, and since when."""
    rule = next(one for one in found.rules.rules if one.name == violation.rule)
    cite = f" [{rule.cite}]" if rule.cite else ""
    objects = ", ".join(f"{name} = {visible(value)}" for name, value in violation.binding.items())
    bound = f" for {objects}" if objects else ""
    return f"{rule.strength} rule {rule.name}{cite}{bound}: {when_lost(found, violation)}"


def when_lost(found: Maneuvers, violation: Violation) -> str:
    """When the rule cannot be kept any more."""
    if violation.step is None:
        return "by how it ends"
    return f"cannot be kept any more from {found.graph.layers[violation.step].start_s:g} s on"


def _penalty(penalty: Mapping[PenaltyRank, Fraction]) -> str:
    if not penalty:
        return "no rule"
    return ", ".join(
        f"{rank.strength} {_levels(rank)} {number_in_words(weight)}"
        for rank, weight in penalty.items()
    )


def _levels(rank: PenaltyRank) -> str:
    return " = ".join(level or "(no level)" for level in rank.levels)


def _plain(number: Fraction) -> int | float:
    return int(number) if number.denominator == 1 else float(number)
