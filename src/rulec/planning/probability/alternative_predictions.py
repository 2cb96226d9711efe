"""Numbers of maneuvers where one obstacle does something less likely."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from rulec.partition.prediction_worlds import named_in, world_graph
from rulec.planning.maneuvers import Maneuvers
from rulec.planning.product.graph_instances import HARD
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.rule_instances import bind_rules, in_rule_words, past_for
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class AlternativeCounts:
    """Numbers of maneuvers if prediction ``number`` of an obstacle comes true.

    All others do what is likeliest. On so many ``traces`` nobody hits ego; those that are
    ``satisfying`` also keep every hard rule then.
    """

    __repr__ = short_repr

    obstacle: str
    number: int
    weight: Fraction
    traces: int
    satisfying: int


def alternative_counts(maneuvers: Maneuvers) -> list[AlternativeCounts]:
    """The counts for every prediction that is not an obstacle's likeliest: exact."""
    return [
        AlternativeCounts(
            obstacle.id, number, alternative.weight, *_counts(maneuvers, obstacle.id, number)
        )
        for obstacle in maneuvers.graph.scenario.obstacles
        for number, alternative in enumerate(obstacle.alternatives, start=1)
    ]


def _counts(maneuvers: Maneuvers, obstacle: str, number: int) -> tuple[int, int]:
    graph, rules = maneuvers.graph, maneuvers.rules
    world = {obstacle: number}
    traces = world_graph(graph, world)
    if traces is None:
        return 0, 0
    paths = in_rule_words(graph, traces, named_in(graph, world), rules.vocabulary)
    past = past_for(graph, paths, rules, HARD, maneuvers.after)
    hard = node_transformers(paths, bind_rules(graph, paths, rules, HARD, past))
    return count_paths(paths), explore(hard).accepted
