"""Rules bound to a graph's objects, with the letters of every node."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.monitoring.implied_values import with_implied_in_graph
from rulec.monitoring.state_validation import check_objects, check_states
from rulec.monitoring.uncertainty.known_words import run
from rulec.monitoring.verdict import NO_PAST, CarriedState, Violation
from rulec.planning.product.graph_instance import GraphInstance
from rulec.planning.product.possible_instances import PossibleNodes
from rulec.rulebook.rulebook_model import Strength
from rulec.trace import TraceGraph

HARD: tuple[Strength, ...] = ("hard",)
SOFT: tuple[Strength, ...] = ("soft",)


def instances(
    graph: TraceGraph,
    rulebook: CompiledRulebook,
    step_s: Fraction | None = None,
    strengths: Collection[Strength] = HARD,
    past: CarriedState = NO_PAST,
) -> list[GraphInstance]:
    """Bind rules of these strengths to a graph's objects.

    ``step_s`` is the graph's exact step if it is not a decimal, such as a third of a second.
    Bindings of a rule with the same letters in every node are one instance. Bindings settled in the
    ``past`` are left out, the others continue from their state; rules that cannot be judged,
    because the graph does not provide what they need, are left out too. Raises RulecError: R0502 to
    R0505 if the graph does not supply what the rules read, R0507 if one of these rules was compiled
    for another step, R0508 if a state contradicts a fact.
    """
    vocabulary = rulebook.vocabulary
    rules = [rule for rule in rulebook.rules if rule.strength in strengths]
    for rule in rules:
        check_step(rule, exact_step(graph.step_s) if step_s is None else step_s, "the graph")
    check_objects(graph.objects, vocabulary)
    places = [f"a cell of layer {layer}".format for layer in range(len(graph.states))]
    for states, where in zip(graph.states, places, strict=True):
        check_states(states, graph.objects, vocabulary, where)
    possible = PossibleNodes(with_implied_in_graph(graph, vocabulary), rulebook, places)
    possible.check_counting_axioms()
    return [own for rule in rules for own in possible.instances(rule, past)]


def violations(rules: Sequence[GraphInstance], nodes: Sequence[int]) -> tuple[Violation, ...]:
    """Violations on a path whose letters are known, with the layer of each bad prefix."""
    result = []
    for rule in rules:
        path = nodes[rule.first : rule.last + 1]
        word = [row[node] for row, node in zip(rule.letters, path, strict=True)]
        accepted, lost = run(rule.rule.machine, word, rule.start)
        if not accepted:
            layer = None if lost is None else rule.first + lost
            result += [
                Violation(rule.rule.name, rule.rule.strength, binding.objects, layer)
                for binding in rule.bindings
            ]
    return tuple(result)
