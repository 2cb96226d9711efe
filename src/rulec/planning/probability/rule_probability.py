"""Exact probability that a maneuver keeps each rule, and counts for other predictions.

Obstacles follow their predictions independently of each other. Whatever they do, ego goes through
the same cells. It keeps a rule for some objects if its trace does and none of them hits it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.partition.prediction_worlds import named_in, predicted_path, world_graph
from rulec.planning.maneuvers import Maneuvers
from rulec.planning.probability.violation_events import (
    Event,
    Lost,
    ViolationEvents,
    Weights,
    none_of,
)
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import HARD
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.rule_instances import bind_rules, in_rule_words, past_for
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class ForObjects:
    """The probability that a rule is kept for these objects of the scenario.

    If not everything is known, it is at least ``kept`` and at most ``at_most``.
    """

    binding: Mapping[str, str]
    kept: Fraction
    at_most: Fraction


@dataclass(frozen=True, slots=True)
class RuleProbability:
    """The probability that a rule is kept, with bounds as in ``ForObjects``, and bindings below 1.

    None if the rule counts objects, and their predictions have too many combinations.
    """

    __repr__ = short_repr

    rule: CompiledRule
    kept: Fraction | None
    bindings: tuple[ForObjects, ...]
    at_most: Fraction | None = None


@dataclass(frozen=True, slots=True)
class RuleProbabilities:
    """Probabilities of no collision, of all hard rules kept (None if unknown), and of each rule."""

    __repr__ = short_repr

    clear: Fraction
    hard: Fraction | None
    rules: tuple[RuleProbability, ...]
    hard_at_most: Fraction | None = None


def rule_probabilities(maneuvers: Maneuvers, maneuver: Maneuver) -> RuleProbabilities:
    """Exact probabilities of one maneuver. Raises RulecError as ``best`` does.

    If not everything is known they are bounds: of the worlds in which a rule is surely kept, and of
    those in which it is not surely violated.
    """
    path = predicted_path(maneuvers.graph, maneuver.nodes)
    surely = perhaps = ViolationEvents(maneuvers, path)
    if surely.in_doubt:
        perhaps = ViolationEvents(maneuvers, path, perhaps=True)
    not_judged = {rule.rule for rule in maneuvers.not_judged}
    rules, hard = [], []
    for rule in maneuvers.rules.rules:
        if rule.name in not_judged:
            continue
        lost = surely.events(rule)
        lost_for_sure = lost if perhaps is surely else perhaps.events(rule)
        rules.append(_of_rule(rule, lost, lost_for_sure, path.weights))
        if rule.strength == "hard":
            hard.append((lost, lost_for_sure))
    kept, at_most = (
        _of_all(surely.hits, [each[reading] for each in hard], path.weights) for reading in (0, 1)
    )
    return RuleProbabilities(none_of(surely.hits, path.weights), kept, tuple(rules), at_most)


def _of_all(hits: set[Event], lost: Iterable[Lost | None], weights: Weights) -> Fraction | None:
    """The probability that nobody hits ego and none of these events happens."""
    events = set(hits)
    for each in lost:
        if each is None:
            return None
        events.update(*each.values())
    return none_of(events, weights)


def _of_rule(
    rule: CompiledRule, lost: Lost | None, lost_for_sure: Lost | None, weights: Weights
) -> RuleProbability:
    if lost is None or lost_for_sure is None:
        return RuleProbability(rule, None, ())
    names = [variable.name for variable in rule.variables]
    bindings = tuple(
        ForObjects(
            dict(zip(names, objects, strict=True)),
            none_of(events, weights),
            none_of(lost_for_sure.get(objects, ()), weights),
        )
        for objects, events in lost.items()
        if objects
    )
    kept, at_most = (
        none_of(set().union(*each.values()), weights) for each in (lost, lost_for_sure)
    )
    return RuleProbability(rule, kept, bindings, at_most)


@dataclass(frozen=True, slots=True)
class AlternativeCounts:
    """Numbers of maneuvers if prediction ``number`` of an obstacle comes true.

    All others do what is likeliest. ``traces`` counts the maneuvers on which nobody hits ego,
    ``satisfying`` those of them that keep every hard rule, and ``open`` those where that depends on
    unknown values.
    """

    __repr__ = short_repr

    obstacle: str
    number: int
    weight: Fraction
    traces: int
    satisfying: int
    open: int = 0


def alternative_counts(maneuvers: Maneuvers) -> list[AlternativeCounts]:
    """The exact counts for every prediction that is not an obstacle's likeliest."""
    return [
        AlternativeCounts(
            obstacle.id, number, alternative.weight, *_counts(maneuvers, obstacle.id, number)
        )
        for obstacle in maneuvers.graph.scenario.obstacles
        for number, alternative in enumerate(obstacle.alternatives, start=1)
    ]


def _counts(maneuvers: Maneuvers, obstacle: str, number: int) -> tuple[int, int, int]:
    graph, rules = maneuvers.graph, maneuvers.rules
    world = {obstacle: number}
    traces = world_graph(graph, world)
    if traces is None:
        return 0, 0, 0
    obstacles = named_in(graph, world)
    paths = in_rule_words(graph, traces, obstacles, rules.vocabulary, maneuvers.reading)
    past = past_for(graph, paths, rules, HARD, maneuvers.after)
    bound = bind_rules(graph, paths, rules, HARD, past)
    kept = explore(node_transformers(paths, bound)).accepted
    doubtful = 0
    if any(instance.readings for instance in bound):
        doubtful = explore(node_transformers(paths, bound, perhaps=True)).accepted - kept
    return count_paths(paths), kept, doubtful
