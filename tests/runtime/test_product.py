"""Counting and searching without enumerating, against enumerating."""

from fractions import Fraction
from itertools import islice, pairwise, product

from books import P, Q, always, book, both, compile_here, eventually, far, implies, near, no, rule
from graphs import graphs
from hypothesis import given
from words import formulas

from rulec.automata.compiler import compile_rulebook
from rulec.logic.formula import atoms_of
from rulec.runtime.cheapest import cheapest
from rulec.runtime.effects import effects
from rulec.runtime.instances import instances
from rulec.runtime.product import count_paths, explore
from rulec.runtime.verify import verify
from rulec.trace import TraceGraph
from rulec.trace.paths import all_traces, paths, trace_of

RULES = compile_rulebook(
    book(
        rule("never_near_then_far", always(no(both(near("x"), eventually(far("x"))))), "x: car"),
        rule("no_two_near", always(no(both(near("x"), near("y")))), "x: thing", "y: thing"),
        rule("p_is_answered", always(implies(P, eventually(Q)))),
        rule("ends_in_q", eventually(always(Q)), strength="soft"),
    )
)


def enumerate_paths(graph):
    """Every sequence of nodes that is a path: by trying them all."""
    for path in product(*(range(len(layer)) for layer in graph.states)):
        if (
            path[0] == graph.start
            and path[-1] in graph.goals
            and all(
                after in graph.successors[layer][here]
                for layer, (here, after) in enumerate(pairwise(path))
            )
        ):
            yield path


@given(graphs())
def test_paths_are_all_the_paths_in_order(graph):
    assert list(paths(graph)) == list(enumerate_paths(graph))
    assert count_paths(graph) == len(list(enumerate_paths(graph)))


@given(graphs(objects=("car1", "car2")))
def test_counts_are_those_of_enumeration(graph):
    satisfying = [
        path
        for path in enumerate_paths(graph)
        if verify(trace_of(graph, path, ""), RULES).satisfied
    ]
    explored = explore(effects(graph, instances(graph, RULES)))
    assert explored.accepted == len(satisfying)
    assert sorted(maneuver.nodes for maneuver in cheapest(explored)) == satisfying


@given(formulas, graphs())
def test_any_rule_counts_as_enumeration_does(formula, graph):
    x = ("x: thing",) if any(atom.arguments for atom in atoms_of(formula)) else ()
    rules = compile_here(book(rule("A", formula, *x)))
    verdicts = [verify(trace, rules).satisfied for trace in all_traces(graph, "t", 10**6)]
    assert explore(effects(graph, instances(graph, rules))).accepted == sum(verdicts)


@given(graphs())
def test_the_cheapest_come_first_with_their_cost_and_margin(graph):
    explored = explore(effects(graph, instances(graph, RULES)))
    found = list(cheapest(explored))
    assert [(m.cost, m.nodes) for m in found] == sorted((m.cost, m.nodes) for m in found)
    assert list(islice(cheapest(explored), 3)) == found[:3]
    for maneuver in found:
        margins = [
            graph.margins[layer][here][graph.successors[layer][here].index(after)]
            for layer, (here, after) in enumerate(pairwise(maneuver.nodes))
        ]
        changes = [Fraction(margin, 2) for margin in margins if margin is not None]  # in s
        assert maneuver.cost == float(sum(1 / margin for margin in changes))
        assert maneuver.margin_s == (float(min(changes)) if changes else None)


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
    (only,) = cheapest(explore(effects(graph, instances(graph, RULES))))
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
    assert explore(effects(graph, instances(graph, RULES))).accepted == 1


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
    explored = explore(effects(graph, instances(graph, RULES)))
    assert explored.accepted == 0
    assert list(cheapest(explored)) == []
