"""Bindings of rules to a graph's objects that some path may violate."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.monitoring.bindings import Binding, Cast, binding_of, types_of
from rulec.monitoring.uncertainty.lazy_bindings import ReadBits, doubtful_bindings
from rulec.monitoring.verdict import CarriedState
from rulec.trace import TraceGraph
from rulec.vocabulary import Vocabulary


def graph_bindings(
    rule: CompiledRule,
    graph: TraceGraph,
    vocabulary: Vocabulary,
    read: Sequence[ReadBits],
    past: CarriedState,
) -> Iterator[Binding]:
    """A rule's bindings, from layer to layer; ``read`` are the readers of the layers' nodes.

    Raises RulecError R0718 if they are too many, even of those that matter.
    """
    cast = Cast(graph.objects, vocabulary, len(graph.states), graph.present)
    if not cast.has_many(types_of(rule)):
        return cast.bindings(rule)
    # Words of letters that are not known, 10 ms: only where there are many choices.
    from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine

    nodes = _Nodes(graph, read)
    in_nodes = Cast(graph.objects, vocabulary, nodes.ends[-1], nodes.present())
    found = doubtful_bindings(
        rule, in_nodes, nodes.bits, uncertain_machine(rule, None).idle, past.begun(rule.name)
    )
    return (binding_of(own.objects, graph.present, len(graph.states)) for own in found)


class _Nodes:
    """The nodes of all layers, one after the other, as if they were states of one trace."""

    def __init__(self, graph: TraceGraph, read: Sequence[ReadBits]) -> None:
        self._graph, self._read = graph, read
        self.ends = list(accumulate(map(len, graph.states)))

    def present(self) -> dict[str, tuple[int, int]]:
        """Among which nodes objects are that are not in all layers."""
        begins = [0, *self.ends]
        stretches = self._graph.present.items()
        return {item: (begins[first], self.ends[last] - 1) for item, (first, last) in stretches}

    def bits(
        self, read: Read | NumberRead, chosen: Mapping[str, str], stretch: tuple[int, int]
    ) -> list[int]:
        """The digits, as bits, that a read may have in nodes of whole layers."""
        first, last = stretch
        found: list[int] = []
        for layer in range(bisect_right(self.ends, first), bisect_right(self.ends, last) + 1):
            n_nodes = len(self._graph.states[layer])
            digits = self._read[layer](read, chosen, (0, n_nodes - 1)) if n_nodes else []
            found += [digits] * n_nodes if isinstance(digits, int) else digits
        return found
