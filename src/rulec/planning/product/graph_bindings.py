"""The bindings of rules to a graph's objects that some path may violate."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.bindings import Binding, Cast, binding_of, types_of
from rulec.monitoring.uncertainty.lazy_bindings import ReadBits, doubtful_bindings
from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine
from rulec.monitoring.verdict import CarriedState
from rulec.planning.product.nodes_in_turn import NodesInTurn
from rulec.trace import TraceGraph
from rulec.vocabulary import Vocabulary


def graph_bindings(
    rule: CompiledRule,
    graph: TraceGraph,
    vocabulary: Vocabulary,
    read: ReadBits,
    past: CarriedState,
) -> Iterator[Binding]:
    """A rule's bindings, with their layers; ``read`` reads the states of ``NodesInTurn``.

    Raises RulecError R0718 if there are too many, even of those that matter.
    """
    cast = Cast(graph.objects, vocabulary, len(graph.states), graph.present)
    if not cast.has_many(types_of(rule)):
        return cast.bindings(rule)
    nodes = NodesInTurn(graph)
    in_nodes = Cast(graph.objects, vocabulary, len(nodes.states), nodes.present)
    bindings = doubtful_bindings(
        rule, in_nodes, read, uncertain_machine(rule, None).idle, past.begun(rule.name)
    )
    return (binding_of(own.objects, graph.present, len(graph.states)) for own in bindings)
