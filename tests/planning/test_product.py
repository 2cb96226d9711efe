"""Counting and searching without enumerating, against enumerating."""

from fractions import Fraction

from hypothesis import given

from rulec.automata.compiler import compile_rulebook
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import instances
from rulec.planning.ranking.cheapest import cheapest
from rulec.trace import TraceGraph
from rulec.trace.trace_model import paths
from support.builders.rulebooks import (
    P,
    Q,
    always,
    book,
    both,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)
from support.generators.random_graphs import graphs
from support.oracles.maneuver_oracle import every_path

RULES = compile_rulebook(
    book(
        rule("never_near_then_far", always(no(both(near("x"), eventually(far("x"))))), "x: car"),
        rule("no_two_near", always(no(both(near("x"), near("y")))), "x: thing", "y: thing"),
        rule("p_is_answered", always(implies(P, eventually(Q)))),
        rule("ends_in_q", eventually(always(Q)), strength="soft"),
    )
)


@given(graphs())
def test_paths_are_all_the_paths_in_order(graph):
    assert list(paths(graph)) == [*every_path(graph)]
    assert count_paths(graph) == len([*every_path(graph)])


def test_paths_do_not_wander_into_dead_ends():
    """A ladder of 60 layers whose only way to the goal is the right rail: found at once."""
    n = 60
    state = {"place": {}, "p": True, "q": True}
    graph = TraceGraph(
        1.0,
        {},
        {},
        states=((state, state, state),) * n,
        # 0 and 1 are a maze without exit, 2 is reached from the start alone.
        successors=(((0, 1, 2), (0, 1), (2,)), *(((0, 1), (0, 1), (2,)),) * (n - 2)),
        weights=((((1,) * 3), (1, 1), (0,)), *(((1, 1), (1, 1), (0,)),) * (n - 2)),
        margins=(((1, 1, 1), (1, 1), (None,)), *(((1, 1), (1, 1), (None,)),) * (n - 2)),
        cost_unit=Fraction(1),
        start=0,
        goals=(2,),
    )
    assert list(paths(graph)) == [(0,) + (2,) * (n - 1)]
    (only,) = cheapest(explore(node_transformers(graph, instances(graph, RULES))))
    assert only.cost == 1.0


def test_counts_beyond_any_machine_number():
    n = 101
    state = {"p": False, "q": False}
    both_ways = ((0, 1), (0, 1))
    graph = TraceGraph(
        1.0,
        {},
        {},
        states=((state, {"p": True, "q": False}),) * n,
        successors=(both_ways,) * (n - 1),
        weights=(both_ways,) * (n - 1),
        margins=(both_ways,) * (n - 1),
        cost_unit=Fraction(1),
        start=0,
        goals=(0, 1),
    )
    assert count_paths(graph) == 2 ** (n - 1)
    # Of these only the one without any p has nothing that would have to be answered.
    assert explore(node_transformers(graph, instances(graph, RULES))).accepted == 1


def test_a_layer_may_be_empty():
    """Where the road has ended there is nothing to be, and no path."""
    state = {"place": {"car1": "near"}, "p": True, "q": True}
    graph = TraceGraph(
        1.0,
        {"car1": "car"},
        {},
        states=((state,), ()),
        successors=(((),),),
        weights=(((),),),
        margins=(((),),),
        cost_unit=Fraction(1),
        start=0,
        goals=(),
    )
    explored = explore(node_transformers(graph, instances(graph, RULES)))
    assert explored.accepted == 0
    assert list(cheapest(explored)) == []
