"""Probabilities that maneuvers keep rules, as text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import prod

from rulec.planning.probability.rule_probability import (
    AlternativeCounts,
    RuleProbabilities,
    RuleProbability,
)
from rulec.planning.probability.violation_events import MOST_WORLDS
from rulec.report.text.count_text import shown_count
from rulec.report.text.terminal_text import table_lines, visible
from rulec.scenario import Scenario

MOST_BINDINGS = 3
"""For so many objects a rule's probability is said in text; JSON has them all."""


def lines(chances: RuleProbabilities) -> list[str]:
    """The probabilities that are below 1, a line each."""
    rows = [("nobody hits ego", _shown(chances.clear)), ("every hard rule", _shown(chances.hard))]
    rows += [(rule.rule.name, _of_rule(rule)) for rule in chances.rules if rule.kept != 1]
    return table_lines(rows, indent="   ")


def summary(scenario: Scenario) -> Iterator[str]:
    """A line on what was counted, if obstacles have several predictions."""
    several = [obstacle for obstacle in scenario.obstacles if obstacle.alternatives]
    if several:
        whose = "1 obstacle has" if len(several) == 1 else f"{len(several)} obstacles have"
        how = f"the likeliest world is counted, with probability {likeliest(scenario):.4g}"
        yield f"predictions {whose} several; {how}"


def likeliest(scenario: Scenario) -> float:
    """The probability that all obstacles do what is likeliest."""
    return float(prod((obstacle.weight for obstacle in scenario.obstacles), start=Fraction(1)))


def world_lines(worlds: Sequence[AlternativeCounts]) -> Iterator[str]:
    """A line for each prediction that is not an obstacle's likeliest."""
    for world in worlds:
        yield visible(
            f"otherwise   {world.obstacle}, prediction {world.number + 1} "
            f"({_shown(world.weight)}): {shown_count(world.traces)} maneuvers, "
            f"{shown_count(world.satisfying)} satisfying"
        )


def _of_rule(rule_probability: RuleProbability) -> str:
    if rule_probability.kept is None:
        return f"not known: more than {MOST_WORLDS:,} worlds make a difference"
    each = [
        f"{_shown(binding.kept)} for "
        + ", ".join(f"{name} = {visible(item)}" for name, item in binding.binding.items())
        for binding in rule_probability.bindings[:MOST_BINDINGS]
    ]
    if len(rule_probability.bindings) > MOST_BINDINGS:
        each.append(f"and for {len(rule_probability.bindings) - MOST_BINDINGS:,} more")
    return "; ".join([_shown(rule_probability.kept), *each])


def _shown(number: Fraction | None) -> str:
    return "not known" if number is None else f"{float(number):.4g}"
