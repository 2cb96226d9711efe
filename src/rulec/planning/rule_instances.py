"""Rules applied to paths through a navigation graph."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.monitoring.verdict import NO_PAST, CarriedState
from rulec.planning.partition_choice import SUPPLIED
from rulec.planning.product.graph_instances import GraphInstance, instances
from rulec.rulebook.rulebook_model import Strength
from rulec.trace import TraceGraph
from rulec.trace.vocabulary_projection import project_graph
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph
    from rulec.planning.trace_history import Before
    from rulec.scenario import Obstacle


def in_rule_words(
    graph: NavigationGraph,
    traces: TraceGraph,
    obstacles: Mapping[str, Obstacle],
    vocabulary: Vocabulary,
) -> TraceGraph:
    """Traces of paths through a graph in the words of a vocabulary.

    ``obstacles`` are the objects of the traces.
    """
    recorded = None
    if graph.scenario.account is not None:
        recorded = {name: (own.type, *own.broader) for name, own in obstacles.items()}
    return project_graph(traces, vocabulary, SUPPLIED, recorded)


def past_for(
    graph: NavigationGraph,
    paths: TraceGraph,
    rules: CompiledRulebook,
    strengths: Collection[Strength],
    after: Before | None,
) -> CarriedState:
    """Carried state of the past, for rules of these strengths.

    Raises RulecError.
    """
    if after is None:
        return NO_PAST
    from rulec.planning.trace_history import past_of  # 30 ms, only where there is a past

    return past_of(paths, after, rules, graph.step, strengths)


def bind_rules(
    graph: NavigationGraph,
    paths: TraceGraph,
    rules: CompiledRulebook,
    strengths: Collection[Strength],
    past: CarriedState,
) -> list[GraphInstance]:
    """Bind rules of these strengths to the objects of a graph.

    Raises RulecError as ``instances`` does, with the scenario as the place.
    """
    try:
        return instances(paths, rules, graph.step, strengths, past)
    except RulecError as error:
        place = SourceLocation(graph.scenario.name)
        raise RulecError(
            [replace(diagnostic, place=place) for diagnostic in error.diagnostics]
        ) from None
