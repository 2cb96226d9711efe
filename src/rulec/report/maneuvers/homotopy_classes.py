"""Homotopy classes of maneuvers, as text."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import named
from rulec.planning import Maneuvers
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant
from rulec.report.maneuvers import maneuver_lines
from rulec.report.text.count_text import shown_count


def count_lines(maneuvers: Maneuvers, classes: HomotopyClasses) -> list[str]:
    """Counts of homotopy classes, and reasons for different verdicts within one."""
    satisfying, total = shown_count(classes.satisfying), shown_count(classes.total)
    lines = [f"classes     {satisfying} of {total} satisfying"]
    if classes.divided:
        counting = [rule.name for rule in maneuvers.counting_steps()]
        why = f": {named(counting)} {'counts' if len(counting) == 1 else 'count'} steps"
        lines.append(
            f"            {shown_count(classes.divided)} of these depending on how long one stays"
            + (why if counting else "")
        )
    return lines


def blocks(maneuvers: Maneuvers, variants: Sequence[Variant]) -> list[str]:
    """A block for every class: its cheapest satisfying member."""
    lines = []
    for number, variant in enumerate(variants, 1):
        many = (
            f"{shown_count(variant.members)} satisfying members"
            if variant.members > 1
            else "1 member"
        )
        lines += ["", f"{number}. {maneuver_lines.in_a_line(variant.cheapest)}; class of {many}"]
        lines += maneuver_lines.cell_lines(maneuvers.graph, variant.cheapest)
    return lines
