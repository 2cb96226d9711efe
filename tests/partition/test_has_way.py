"""Whether there is a way at all, asked without making the whole graph."""

from hypothesis import assume, given
from hypothesis import strategies as st

from rulec import RulecError, navigation_graph
from rulec.partition.navigation_graph import has_way, has_way_within
from rulec.scenario import MotionBounds
from support.generators.random_scenarios import scenarios

BOUNDS = st.sampled_from(["none", MotionBounds(), MotionBounds(acceleration=1.0, braking=1.0)])
FORMS = st.fixed_dictionaries(
    {
        "partition": st.sampled_from(["paper", "fine"]),
        "adjacency": st.sampled_from(["touch", "edge", "forward"]),
        "extent": st.sampled_from(["lane", "body"]),
        "bounds": BOUNDS,
    }
)


def answer_of(ask):
    """An answer, or what is said in its place."""
    try:
        return ask()
    except RulecError as refused:
        return str(refused)


@given(scenarios(), FORMS)
def test_there_is_a_way_where_the_graph_has_one(scenario, options):
    options = {**options, "step_s": scenario.step_s}
    wanted = answer_of(lambda: navigation_graph(scenario, **options).leads_to_a_goal)
    assert answer_of(lambda: has_way(scenario, **options)) == wanted


@given(scenarios(), st.floats(0.5, 6), st.floats(0.5, 6))
def test_tighter_bounds_are_looked_at_within_what_wider_ones_leave(scenario, faster, braking):
    wide, tight = MotionBounds(), MotionBounds(acceleration=faster, braking=braking)
    step_s = scenario.step_s
    graph = answer_of(lambda: navigation_graph(scenario, step_s=step_s, bounds=wide))
    assume(not isinstance(graph, str))
    anew = navigation_graph(scenario, step_s=step_s, bounds=tight).leads_to_a_goal
    assert has_way_within(graph, tight) <= anew
    assert graph.leads_to_a_goal >= anew
