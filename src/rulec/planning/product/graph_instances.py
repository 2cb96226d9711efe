"""Rules bound to a graph's objects, with the letters of every node."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.bindings import Binding
from rulec.monitoring.implied_values import with_implied_in_graph
from rulec.monitoring.letter_reader import LetterReader
from rulec.monitoring.state_validation import StateValidator, check_objects
from rulec.monitoring.uncertainty.lazy_bindings import known_bits
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.monitoring.verdict import NO_PAST, CarriedState, Violation
from rulec.monitoring.verify import run
from rulec.planning.product.graph_bindings import graph_bindings, layer_by_layer
from rulec.planning.product.graph_instance import GraphInstance
from rulec.rulebook.rulebook_model import Strength
from rulec.trace import TraceGraph
from rulec.trace.trace_model import present_in

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
    if graph.told is not None:
        untold = untold_names(rulebook.vocabulary, graph.told)
        rulebook = replace(rulebook, vocabulary=with_untold(rulebook.vocabulary, untold))
    vocabulary = rulebook.vocabulary
    rules = [rule for rule in rulebook.rules if rule.strength in strengths]
    for rule in rules:
        check_step(rule, exact_step(graph.step_s) if step_s is None else step_s, "the graph")
    check_objects(graph.objects, vocabulary)
    validator = StateValidator(vocabulary, graph.objects)
    places = [f"a cell of layer {layer}".format for layer in range(len(graph.states))]
    partial = [validator.check(*layer) for layer in zip(graph.states, places, strict=True)]
    graph = with_implied_in_graph(graph, vocabulary)
    possible = None
    doubtful = past.doubtful_rules
    if any(partial) or graph.told is not None or doubtful:
        # Imported late (15 ms): only if not everything is known.
        from rulec.planning.product.possible_instances import PossibleNodes

        possible = PossibleNodes(graph, rulebook, places)
    columns = [
        LetterReader(
            states,
            rulebook,
            places[layer],
            objects=present_in(layer, graph.objects, graph.present),
        )
        for layer, states in enumerate(graph.states)
    ]
    for states, column, where in zip(graph.states, columns, places, strict=True):
        check_counting_axioms(rulebook, len(states), column.view, where, None)
    result: list[GraphInstance] = []
    for rule in rules:
        if possible is not None and (rule.name in doubtful or possible.concern(rule)):
            result += possible.instances(rule, past)
            continue
        alike: dict[tuple[int, int, tuple[tuple[int, ...], ...]], list[Binding]] = {}
        read = layer_by_layer(graph, [known_bits(column, rule) for column in columns])
        for binding in graph_bindings(rule, graph, vocabulary, read, past):
            letters = tuple(
                columns[layer].word(rule, binding.objects, 0, len(graph.states[layer]) - 1)
                for layer in range(binding.first, binding.last + 1)
            )
            about = (rule.name, tuple(binding.objects.values()))
            stays = binding.first == 0
            if not (stays and about in past.settled):
                start = past.states.get(about, 0) if stays else 0
                alike.setdefault((binding.first, start, letters), []).append(binding)
        result += [
            GraphInstance(rule, tuple(bound), letters, start)
            for (_, start, letters), bound in alike.items()
        ]
    return result


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
