"""Products and rankings that grow too large are refused, and no others."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec import navigation_graph
from rulec.diagnostics import RulecError
from rulec.planning.product.graph_product import explore, largest_product
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import HARD, SOFT, instances
from rulec.planning.ranking.least_violating import Ranking
from rulec.planning.ranking.penalties import ranks_of
from support.generators.random_graphs import graphs
from support.generators.random_priorities import rulebooks

GRAPHS = graphs(objects=("car1", "car2"))


REFUSED = ["R0616"]


def with_room(most, work):
    """What work says where there is room for so many, or the codes of what it is refused for."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("rulec.planning.product.graph_product.MOST", most)
        patched.setattr("rulec.planning.product.graph_product.MOST_PER_NODE", 0)
        try:
            return work()
        except RulecError as refused:
            return [one.code for one in refused.diagnostics]


@given(GRAPHS, rulebooks())
def test_a_product_needs_room_for_its_nodes(graph, rulebook):
    found = node_transformers(graph, instances(graph, rulebook))
    counts = explore(found).counts
    n_nodes = sum(map(len, counts[1:]))
    assert with_room(n_nodes, lambda: explore(found).counts) == counts
    if n_nodes:
        assert with_room(n_nodes - 1, lambda: explore(found)) == REFUSED


@given(GRAPHS, rulebooks(), st.integers(0, 30))
def test_with_little_room_a_ranking_is_the_same_or_none(graph, rulebook, most):
    found = node_transformers(graph, instances(graph, rulebook, strengths=(*HARD, *SOFT)))
    ranking = Ranking(found, ranks_of(rulebook))

    def best():
        return [(one, ranking.with_penalty(one).accepted) for one in ranking.front()]

    for work in (best, lambda: list(ranking.ranked())):
        assert with_room(most, work) in (work(), REFUSED)
        assert with_room(0, work) == (REFUSED if work() else [])


def test_a_large_graph_has_more_room(monkeypatch):

    graph = navigation_graph("s1").trace_graph()
    n_nodes = sum(map(len, graph.states))
    assert largest_product(graph) == 1 << 17
    monkeypatch.setattr("rulec.planning.product.graph_product.MOST", 32 * n_nodes - 1)
    assert largest_product(graph) == 32 * n_nodes
