"""Traces of one rule: they get the verdicts that they are shown for, and none is shorter."""

from itertools import product

import pytest
from hypothesis import given

from rulec.analysis.believable_states import MOST_KMH
from rulec.analysis.rule_traces import rule_traces
from rulec.analysis.shared_compilation import compile_shared
from rulec.monitoring.uncertainty.known_words import run
from rulec.rulebook.loader import parse_rulebook
from support.generators.random_rule_pairs import ALONE, COUNTED, X, allows, formulas, sides


def side_of(text):
    """The last rule of a rulebook, compiled."""
    book = parse_rulebook(text)
    return [*compile_shared([book], [{rule.name: rule for rule in book.rules}])[0].values()][-1]


FOLLOWING = "rulebook r quantity gap in m default 1000 quantity speed in km/h default 0 signal p\n"
CLOSE = "gap < speed * 2 s"


@given(formulas(ALONE))
def test_their_verdicts_and_their_length(formula):
    (one,) = sides([formula], [X], ["stutter"])
    machine = one.rule.machine
    traces = rule_traces(one)
    assert not traces.undecided
    for trace, accepts in ((traces.accepted, True), (traces.rejected, False)):
        assert trace is None or allows(one, trace) is accepts
    symbols = range(len(machine.successors[0]))
    shorter = 3 if traces.rejected is None else min(len(traces.rejected.states), 4)
    for length in range(1, shorter):
        assert all(run(machine, word)[0] for word in product(symbols, repeat=length))
    if traces.accepted is None:
        assert machine.rejecting_sink == 0


@given(formulas(COUNTED))
def test_counted_objects_are_there(formula):
    (one,) = sides([formula], [], ["stutter"])
    traces = rule_traces(one)
    for trace, accepts in ((traces.accepted, True), (traces.rejected, False)):
        assert trace is None or allows(one, trace) is accepts


def test_the_nearest_miss_differs_in_one_value():
    one = side_of(
        "rulebook a signal p, q default false\n"
        "hard rule a { require never (p and next (not p and q)) }"
    )
    traces = rule_traces(one)
    assert traces.rejected.states == ({"p": True, "q": True}, {"q": True})
    # The later state, and there what is not as usual.
    assert traces.accepted.states == ({"p": True, "q": True}, {"q": False})


def test_numbers_are_near_their_limits():
    one = side_of(
        "rulebook a quantity speed in km/h default 0 signal p default false\n"
        "hard rule a { require always (p implies speed <= 50 km/h and speed >= 30 km/h) }"
    )
    assert rule_traces(one).rejected.states == ({"speed": 20.0, "p": True},)
    fast = side_of(
        "rulebook a quantity speed in km/h default 100\n"
        "hard rule a { require always speed <= 50 km/h }"
    )
    traces = rule_traces(fast)
    assert traces.rejected.states == ({},)
    assert traces.accepted.states == ({"speed": 50.0},)


def test_speeds_are_those_of_vehicles():
    """At the usual distance, only 1,801 km/h would be too fast."""
    (state,) = rule_traces(
        side_of(f"{FOLLOWING}hard rule r {{ require never {CLOSE} }}")
    ).rejected.states
    assert 0 < state["speed"] <= MOST_KMH
    assert 1 <= state["gap"] < state["speed"] / 3.6 * 2


ON_THE_ROAD = "rulebook r use road hard rule r (v: vehicle) {{ require never ({}) }}"


@pytest.mark.parametrize(
    ("forbidden", "shown"),
    [
        # It drives too fast to stop at once, and it is as near as can be to where it is.
        ("beside(v) and not can_stop_at_once and speed < 90 km/h", {"speed": 25.0}),
        (
            "crossing and distance_to_crossing <= 900 m",
            {"surface": "crossing", "distance_to_crossing": 1.0},
        ),
        # Only one who stands is forbidden to, and only beside the road is there a lane to be in.
        ("speed < 1 km/h", {"speed": 0.0}),
        ("on_shoulder(v) and same_lane(v)", {"lateral": {"v": "same_lane"}}),
    ],
)
def test_states_are_believed_where_they_can_be(forbidden, shown):
    (state,) = rule_traces(side_of(ON_THE_ROAD.format(forbidden))).rejected.states
    assert shown.items() <= ({"speed": 0.0} | state).items()


@pytest.mark.parametrize(
    ("required", "accepted", "rejected"),
    [("never (p and not p)", True, False), ("always (p and not p)", False, True)],
)
def test_a_rule_that_nothing_violates_or_keeps(required, accepted, rejected):
    traces = rule_traces(side_of(f"rulebook a signal p hard rule r {{ require {required} }}"))
    assert (traces.accepted is not None, traces.rejected is not None) == (accepted, rejected)


TRAM = """rulebook sample
signal tram, moves, stands default false
constant tram
"""


def test_what_cannot_change_does_not_change():
    turned = f"{TRAM}hard rule r {{ require never (not tram and previously tram) }}"
    # Nothing but a tram that becomes none would be forbidden: there is no such drive.
    assert rule_traces(side_of(turned)).rejected is None
    moved = f"{TRAM}hard rule r {{ require never (tram and not stands and previously stands) }}"
    traces = rule_traces(side_of(moved))
    for trace in (traces.rejected, traces.accepted):
        assert [state.get("tram", False) for state in trace.states] == [True, True]


TO_ITSELF = """rulebook r
type a
signal p default false
quantity d(x: a, y: a) in m default 0
hard rule r (v: a) {{ require always (p or every x: a ({condition}d(v, x) - d(x, v) != 1 m)) }}
"""


def test_a_difference_of_a_number_and_itself_is_zero():
    assert rule_traces(side_of(TO_ITSELF.format(condition="x = v implies "))).rejected is None
    # One beside the rule's own
    assert len(rule_traces(side_of(TO_ITSELF.format(condition=""))).rejected.objects) == 2


def test_a_count_that_always_fits_beside_one_that_may_not():
    one = side_of(
        "rulebook r type a signal p(x: a) default false hard rule r { "
        "require always (count x: a (p(x)) <= 1 and count x: a (not p(x)) >= 0) }"
    )
    assert len(rule_traces(one).rejected.objects) == 2
