"""Evaluating a navigation graph by a compiled rulebook, which gives its maneuvers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.fault_containment import without_words
from rulec.monitoring.verdict import CarriedState, RuleNotJudged
from rulec.partition import NavigationGraph
from rulec.planning.maneuvers import AS_WRITTEN, Maneuvers
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import HARD, not_judged
from rulec.planning.rule_instances import (
    SceneReading,
    bind_rules,
    check_constants,
    in_rule_words,
    past_for,
)
from rulec.trace import TraceGraph

if TYPE_CHECKING:
    from rulec.cell_words import CellWords
    from rulec.planning.trace_history import Before


def evaluate(
    graph: NavigationGraph,
    rules: CompiledRulebook,
    after: Before | None = None,
    reading: SceneReading = AS_WRITTEN,
    words: CellWords | None = None,
) -> Maneuvers:
    """Count a graph's paths, and those that keep every hard rule.

    ``after`` is the trace or monitor that led up to the first layer, ``words`` are the values in
    the graph's cells, and ``reading`` gives values that they, or the scenario, do not provide.
    Raises RulecError: R0502 to R0505 if the graph does not supply what the rules read, R0507 if a
    hard rule was compiled for another step; R0501 to R0511 if ``after`` is not a valid past.
    """
    faults, told = (words.faults, words.told) if words else ({}, None)
    rules, lost = without_words(rules.fitted_to(graph.step), faults, told)
    traces = graph.trace_graph()
    paths = in_rule_words(graph, traces, graph.objects, rules.vocabulary, reading, words=words)
    past = past_for(graph, paths, rules, HARD, after)
    if past.constants:
        reading = reading.after(past.constants)
        paths = in_rule_words(graph, traces, graph.objects, rules.vocabulary, reading, words=words)
        check_constants(paths, past)
    bound = bind_rules(graph, paths, rules, HARD, past)
    hard = perhaps = node_transformers(paths, bound)
    product = possible = explore(hard)
    if any(instance.readings for instance in bound):
        perhaps = node_transformers(paths, bound, perhaps=True)
        possible = explore(perhaps)
    return Maneuvers(
        graph=graph,
        rules=rules,
        paths=paths,
        traces=count_paths(paths),
        hard=hard,
        product=product,
        perhaps=perhaps,
        possible=possible,
        past=past,
        after=after,
        violated_before=None if after is None else past.violations,
        not_judged=(*_not_judged(paths, rules, past), *lost),
        reading=reading,
        words=words,
    )


def _not_judged(
    paths: TraceGraph, rules: CompiledRulebook, past: CarriedState
) -> tuple[RuleNotJudged, ...]:
    if paths.told is None:
        return ()
    return tuple(not_judged(paths, rules, past))
