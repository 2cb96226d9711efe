"""Random scenarios: counting by the dynamic programme gives what enumeration gives."""

from hypothesis import assume, given
from hypothesis import strategies as st

from rulec import compile_rulebook, navigation_graph
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.verify import verify
from rulec.planning.product.graph_product import count_paths, explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import instances
from rulec.planning.ranking.cheapest import cheapest
from rulec.rulebook.loader import parse_rulebook
from rulec.trace.trace_model import all_traces
from support.generators.random_scenarios import scenarios

PAPER = compile_rulebook("esterle2019")
FINE = compile_rulebook(
    parse_rulebook(
        """
        rulebook passing
        use road
        signal CONGESTED
        hard rule on_the_left (v: road_user) {
          require not CONGESTED implies always not
            (behind(v) and next (behind(v) until beside(v) and right_of(v) until in_front_of(v)))
        }
        hard rule not_between (v: vehicle, w: road_user) {
          require always not (behind(v) and in_front_of(w))
        }
        hard rule comes_past (p: pedestrian) { require eventually always not behind(p) }
        """
    )
)
MOST = 3000


@given(scenarios(most=3), st.sampled_from(["paper", "fine"]))
def test_counts_of_random_scenarios(scenario, partition):
    rules = PAPER if partition == "paper" else FINE
    try:
        graph = navigation_graph(scenario, partition=partition).trace_graph()
    except RulecError:
        assume(False)
    total = count_paths(graph)
    assume(total <= MOST)
    traces = list(all_traces(graph, "t", MOST + 1))
    assert len(traces) == total
    satisfying = sum(verify(trace, rules).satisfied for trace in traces)
    explored = explore(node_transformers(graph, instances(graph, rules)))
    assert explored.accepted == satisfying
    assert len(list(cheapest(explored))) == satisfying
