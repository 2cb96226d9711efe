"""Levels of priority: reachability in the graph of what the lines say."""

from itertools import pairwise

import networkx
from hypothesis import given
from hypothesis import strategies as st

from rulec.rulebook.overlay.priorities import MOST_LEVELS, pre_order
from rulec.syntax import tree

names = st.sampled_from("abcdefg")
lines = st.lists(
    st.lists(st.tuples(names, st.sampled_from([">", ">", "="])), min_size=2, max_size=4), max_size=5
)


def line_of(pairs):
    levels = tuple(tree.Name(name) for name, _ in pairs)
    return tree.PriorityLine(levels, tuple(sign for _, sign in pairs[1:]))


@given(lines)
def test_the_order_is_reachability(some):
    levels, order, mistakes = pre_order([line_of(pairs) for pairs in some])
    graph, strict, contradictions = networkx.DiGraph(), [], 0
    for pairs in some:
        for (higher, _), (lower, sign) in pairwise(pairs):
            larger = graph.copy()
            larger.add_edge(higher, lower)
            if sign == "=":
                larger.add_edge(lower, higher)
            demanded = strict + ([(higher, lower)] if sign == ">" else [])
            # A level above another one is not below it, too.
            if any(networkx.has_path(larger, below, above) for above, below in demanded):
                contradictions += 1
                continue
            graph, strict = larger, demanded
    assert set(levels) == {name for pairs in some for name, _ in pairs}
    wanted = {
        (one, other)
        for one in graph
        for other in graph
        if one != other and networkx.has_path(graph, one, other)
    }
    assert order == wanted
    assert len(mistakes) == contradictions


def test_levels_are_named_once_each_in_their_order():
    pairs = [[("b", ">"), ("a", ">")], [("c", ">"), ("b", ">")]]
    levels, order, _ = pre_order([line_of(one) for one in pairs])
    assert levels == ("b", "a", "c")
    assert order == {("b", "a"), ("c", "b"), ("c", "a")}


def test_a_level_is_of_its_own_rank():
    _, order, mistakes = pre_order([line_of([("a", ">"), ("a", "=")])])
    assert (order, mistakes) == (frozenset(), [])


def test_a_contradiction_is_left_out_and_said():
    text = [[("a", ">"), ("b", ">")], [("b", ">"), ("a", ">")], [("b", ">"), ("c", ">")]]
    _, order, (mistake,) = pre_order([line_of(one) for one in text])
    assert order == {("a", "b"), ("b", "c"), ("a", "c")}
    assert (mistake.code, "`b > a`" in mistake.message) == ("R0321", True)


def test_more_levels_than_anyone_can_keep_in_mind():
    chain = [(f"level{number}", ">") for number in range(MOST_LEVELS + 1)]
    _, _, (mistake,) = pre_order([line_of(chain)])
    assert mistake.code == "R0327"
    assert pre_order([line_of(chain[:-1])])[2] == []
