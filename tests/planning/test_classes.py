"""Homotopy classes, against sorting every path into its own."""

from dataclasses import replace
from fractions import Fraction
from math import comb

from hypothesis import given

from rulec.automata.mealy_monitor import stutter_invariant
from rulec.planning.product.graph_product import explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import instances
from rulec.planning.ranking.cell_tracks import cell_tracks
from rulec.planning.ranking.homotopy import HomotopyClasses, count_classes, variants
from rulec.trace import TraceGraph
from support.generators.random_graphs import graphs
from support.generators.random_priorities import RULES

STUTTERING = replace(
    RULES, rules=tuple(one for one in RULES.rules if stutter_invariant(one.machine))
)


@given(graphs(objects=("car1",)))
def test_rules_that_do_not_count_steps_divide_no_class(graph):
    graph = replace(graph, present={})
    found = node_transformers(graph, instances(graph, STUTTERING))
    assert count_classes(found, cell_tracks(graph)).divided == 0


STAYING, CHANGING = (None, 0), (2, 6)


def graph_of(*layers, states=None):
    """A graph from its edges: for each node the followers, each with its margin and cost."""
    sizes = [*(len(layer) for layer in layers), len(layers[-1])]
    return TraceGraph(
        1.0,
        {},
        {},
        states=states or tuple(({"p": False, "q": False},) * size for size in sizes),
        successors=tuple(tuple(tuple(row) for row in layer) for layer in layers),
        weights=tuple(
            tuple(tuple(cost for _, cost in row.values()) for row in layer) for layer in layers
        ),
        margins=tuple(
            tuple(tuple(margin for margin, _ in row.values()) for row in layer) for layer in layers
        ),
        cost_unit=Fraction(1, 12),
        start=0,
        goals=tuple(range(sizes[-1])),
    )


TWO_LANES = [{0: STAYING, 1: CHANGING}, {0: CHANGING, 1: STAYING}]


def test_lanes_side_by_side_have_a_class_for_every_number_of_changes():
    graph = graph_of(*[TWO_LANES] * 30)
    assert cell_tracks(graph) == ((0, 1),) * 31
    found = node_transformers(graph, [])
    assert count_classes(found, cell_tracks(graph)) == HomotopyClasses(31, 0, 0)
    listed = list(variants(explore(found), cell_tracks(graph)))
    assert [one.places for one in listed] == [
        (0, 1) * (n // 2) + (0,) * (n % 2) for n in range(1, 32)
    ]
    # A class with k changes has a member for every choice of k steps to change in.
    assert [one.members for one in listed] == [comb(30, k) for k in range(31)]
    assert [one.cheapest.cost for one in listed] == [k / 2 for k in range(31)]


def test_a_rule_that_is_about_where_one_ends_divides_classes_by_place():
    graph = graph_of(
        *[TWO_LANES] * 4, states=(({"p": False, "q": False}, {"p": True, "q": False}),) * 5
    )
    never_p = replace(RULES, rules=tuple(one for one in RULES.rules if one.name == "never_p"))
    assert count_classes(
        node_transformers(graph, instances(graph, never_p)), cell_tracks(graph)
    ) == HomotopyClasses(1, 4, 0)


def test_a_place_is_cells_that_go_on_as_each_other_and_say_the_same():
    splitting = [{0: STAYING, 1: STAYING}]
    joining = [{0: STAYING, 2: CHANGING}, {0: STAYING}]
    graph = graph_of(splitting, joining, [{0: STAYING}, {1: STAYING}, {1: CHANGING}])
    assert cell_tracks(graph) == ((0,), (0, 0), (0, 1, 2), (0, 1, 3))
    quiet, loud = {"p": False, "q": False}, {"p": True, "q": False}
    states = ((quiet,), (quiet, loud), (quiet, quiet, quiet), (loud, quiet, quiet))
    assert cell_tracks(replace(graph, states=states)) == ((0,), (0, 1), (0, 2, 3), (4, 2, 5))
