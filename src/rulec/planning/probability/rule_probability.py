"""Exact probability that a maneuver keeps each rule, and counts for other predictions.

What an obstacle does is independent of what the others do. Whatever they do, ego goes through the
same cells. It keeps a rule for some objects if its trace does and none of these objects hits it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.partition.prediction_worlds import named_in, predicted_path, world_graph
from rulec.planning.maneuvers import Maneuvers
from rulec.planning.probability.event_probability import Event, Weights, none_of
from rulec.planning.probability.violation_events import Lost, ViolationEvents
from rulec.planning.product.graph_instances import HARD
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.rule_instances import bind_rules, in_rule_words, past_for
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class ForObjects:
    """The probability that a rule is kept for these objects, the scenario's."""

    binding: Mapping[str, str]
    kept: Fraction


@dataclass(frozen=True, slots=True)
class RuleProbability:
    """Probability that a rule is kept, and by bindings below 1.

    None if the rule counts objects, and these can do more together than can be looked at.
    """

    __repr__ = short_repr

    rule: CompiledRule
    kept: Fraction | None
    bindings: tuple[ForObjects, ...]


@dataclass(frozen=True, slots=True)
class RuleProbabilities:
    """Probabilities of no collision, of all hard rules (None if unknown), of each rule."""

    __repr__ = short_repr

    clear: Fraction
    hard: Fraction | None
    rules: tuple[RuleProbability, ...]


def rule_probabilities(maneuvers: Maneuvers, maneuver: Maneuver) -> RuleProbabilities:
    """Exact probabilities of one maneuver. Raises RulecError as ``best`` does."""
    path = predicted_path(maneuvers.graph, maneuver.nodes)
    judge = ViolationEvents(maneuvers, path)
    hard: set[Event] | None = set(judge.hits)
    rules = []
    for rule in maneuvers.rules.rules:
        lost = judge.events(rule)
        rules.append(_of_rule(rule, lost, path.weights))
        if rule.strength == "hard":
            hard = None if lost is None or hard is None else hard.union(*lost.values())
    return RuleProbabilities(
        none_of(judge.hits, path.weights),
        None if hard is None else none_of(hard, path.weights),
        tuple(rules),
    )


def _of_rule(rule: CompiledRule, lost: Lost | None, weights: Weights) -> RuleProbability:
    if lost is None:
        return RuleProbability(rule, None, ())
    names = [variable.name for variable in rule.variables]
    bindings = tuple(
        ForObjects(dict(zip(names, objects, strict=True)), none_of(events, weights))
        for objects, events in lost.items()
        if objects
    )
    return RuleProbability(rule, none_of(set().union(*lost.values()), weights), bindings)


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
