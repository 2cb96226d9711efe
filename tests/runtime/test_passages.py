"""Where paths run, against listing every path."""

from itertools import pairwise

from graphs import graphs
from hypothesis import given
from random_priorities import rulebooks

from rulec.runtime.effects import effects
from rulec.runtime.instances import instances
from rulec.runtime.passages import passages
from rulec.runtime.product import explore
from rulec.runtime.verify import verify
from rulec.trace.paths import paths, trace_of


def visited(ways, layers):
    nodes = tuple(frozenset(way[p] for way in ways) for p in range(layers))
    edges = tuple(
        frozenset(list(pairwise(way))[p] for way in ways) for p in range(max(layers - 1, 0))
    )
    return nodes, edges


@given(graphs(objects=("car1", "car2")), rulebooks(strengths=("hard",)))
def test_against_every_path(graph, rulebook):
    every = list(paths(graph))
    kept = [way for way in every if verify(trace_of(graph, way, ""), rulebook).satisfied]
    hard = effects(graph, instances(graph, rulebook))
    found = passages(hard, explore(hard))
    layers = len(graph.states)
    assert (found.possible_nodes, found.possible) == visited(every, layers)
    assert (found.accepted_nodes, found.accepted) == visited(kept, layers)
