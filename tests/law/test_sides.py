"""Sides and strictness of the national rulebooks, on random traces."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.compiler import compile_rulebook
from rulec.monitoring.batch.verify import verify
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from support.builders.national_books import compiled

MIRRORED = {"left_of": "right_of", "right_of": "left_of", "same_lane": "same_lane"}

PLACES = ("behind", "beside", "in_front_of")

# Any order of places, or that of passing, which chance alone seldom finds.
stations = st.one_of(
    st.lists(st.sampled_from(PLACES), min_size=1, max_size=6),
    st.tuples(*[st.integers(1, 2)] * 3).map(
        lambda times: [place for place, n in zip(PLACES, times, strict=True) for _ in range(n)]
    ),
)
surroundings = st.fixed_dictionaries(
    {
        "lateral": st.sampled_from(sorted(MIRRORED)).map(lambda side: {"v": side}),
        "turning_far": st.booleans().map(lambda turns: {"v": turns}),
        "dense_all_lanes": st.booleans(),
        "oncoming_clear": st.booleans(),
        "crossing_zone": st.booleans(),
        "can_stop_at_once": st.booleans(),
        "speed": st.sampled_from([0, 5, 50]),
    }
)


@st.composite
def traces(draw):
    return tuple({"station": {"v": place}, **draw(surroundings)} for place in draw(stations))


def mirrored(drawn):
    return tuple({**one, "lateral": {"v": MIRRORED[one["lateral"]["v"]]}} for one in drawn)


def violated(name, of_states):
    verdict = verify(Trace("t", 1.0, {"v": "car"}, of_states), compiled(name))
    return {one.rule for one in verdict.violations}


@pytest.fixture(scope="module")
def treaty_on_the_left():
    return compile_rulebook(parse_rulebook("rulebook left_hand\nextends vienna\ntraffic left\n"))


@given(traces())
def test_where_traffic_drives_on_the_left_all_is_mirrored(treaty_on_the_left, drawn):
    verdict = verify(Trace("t", 1.0, {"v": "car"}, mirrored(drawn)), treaty_on_the_left)
    assert {one.rule for one in verdict.violations} == violated("vienna", drawn)


@pytest.mark.parametrize("name", ["de", "at", "nl"])
@given(drawn=traces())
def test_a_ban_at_crossings_is_stricter_than_the_treaty(name, drawn):
    if "crossing_overtaking" in violated("vienna", drawn):
        assert "crossing_overtaking" in violated(name, drawn)


@given(traces())
def test_at_crossings_it_does_not_matter_on_which_side_one_overtakes(drawn):
    for name in ("vienna", "gb"):
        here, there = violated(name, drawn), violated(name, mirrored(drawn))
        assert ("crossing_overtaking" in here) == ("crossing_overtaking" in there)
