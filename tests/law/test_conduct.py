"""Whom the shared patterns of conduct bind: who stops, passes or changes lanes, and no other."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.compiler import compile_rulebook
from rulec.monitoring.batch.verify import verify
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from support.builders.national_books import NATIONAL, compiled, read

STEPS = (Fraction(1), Fraction(1, 10), Fraction(1, 25))

RED_TURN = {"light": "red_light", "turn": "turn_near", "turn_on_red_sign": True}
STOPS = [
    *((book, "stop_sign", {"stop_sign": True}, "crosses_stop_line") for book in ("de", "fr", "gb")),
    *((book, "stop_sign", {"stop_sign": True}, "crosses_stop_line") for book in ("us-ca", "in")),
    *((book, "red_light", RED_TURN, "crosses_light_line") for book in ("de", "pl", "us-ca")),
    ("au-nsw", "red_light", RED_TURN, "crosses_light_line"),
    ("jp", "stop_at_level_crossings", {}, "enters_level_crossing"),
]
of_each_stop = pytest.mark.parametrize(("book", "rule", "sign", "line"), STOPS)
ENDS = ["stutter", "finite"]
of_each_end = pytest.mark.parametrize("ends", ENDS)


@cache
def ending(name: str, ends: str) -> Rulebook:
    return parse_rulebook(f"rulebook heir\nextends {name}\nsemantics {ends}\n")


@cache
def book_on(name: str, rule: str, ends: str, step: Fraction) -> CompiledRulebook:
    book = ending(name, ends)
    alone = replace(book, rules=tuple(one for one in book.rules if one.name == rule))
    return compile_rulebook(alone, step_s=step)


def violations(book, states, objects=None):
    step = float(book.rules[0].step_s or 1)
    return verify(Trace("t", step, objects or {}, tuple(states)), book).violations


def drive(line, sign, *course):
    """States of (speed, on the line)."""
    return [{**sign, "speed": speed, line: over} for speed, over in course]


def at_each_step():
    """Every stop at every step and end, most of them in the long profile alone."""
    for stop, step, ends in product(STOPS, STEPS, ENDS):
        is_brief = stop in (STOPS[0], STOPS[5]) or (step, ends) == (STEPS[1], ENDS[0])
        yield pytest.param(*stop, step, ends, marks=[] if is_brief else [pytest.mark.long])


@pytest.mark.parametrize(("book", "rule", "sign", "line", "step", "ends"), list(at_each_step()))
def test_a_trace_may_end_on_the_line_after_a_stop(book, rule, sign, line, step, ends):
    judge = book_on(book, rule, ends, step)
    seconds = int(1 / step)
    stands, rolls, crosses = (0, False), (5, False), (5, True)
    for last in (1, 2, 3):
        assert not violations(
            judge, drive(line, sign, stands, *[rolls] * seconds, *[crosses] * last)
        )
    assert violations(judge, drive(line, sign, *[rolls] * seconds, crosses))
    assert violations(judge, drive(line, sign, stands, *[rolls] * 11 * seconds, crosses))
    assert not violations(judge, drive(line, sign, crosses))


CREEPING = 30  # km/h


def stops_well(course, memory):
    """Whether, whenever the line is reached, ego stands, or stood off it and has crept since."""
    for now in range(1, len(course)):
        if not course[now][1] or course[now - 1][1] or course[now][0] == 0:
            continue
        before = range(now - 1, max(now - 2 - memory, -1), -1)
        for then in before:
            if course[then][1] or course[then][0] > CREEPING:
                return False
            if course[then][0] == 0:
                break
        else:
            return False
    return True


courses = st.lists(st.tuples(st.sampled_from([0, 5, 35]), st.booleans()), min_size=1, max_size=16)


@of_each_end
@of_each_stop
@given(course=courses)
def test_stops_are_those_of_the_definition(book, rule, sign, line, ends, course):
    judge = book_on(book, rule, ends, Fraction(1))
    assert (not violations(judge, drive(line, sign, *course))) is stops_well(course, 10)


PLACES = st.sampled_from(["behind", "beside", "in_front_of"])
encounters = st.lists(
    st.tuples(PLACES, st.sampled_from([0, 20]), st.sampled_from([-5, 0, 5])), min_size=1, max_size=6
)


@pytest.mark.parametrize("name", ["de", "fr", "pl", "gb", "ie", "it", "us-ca", "au-nsw"])
@given(encounter=encounters)
def test_only_who_passes_keeps_a_gap_to_the_side(name, encounter):
    states = [
        {
            "station": {"c": place},
            "lateral": {"c": "left_of"},
            "lateral_gap": {"c": 0.5},
            "speed": speed,
            "speed_difference": {"c": faster},
        }
        for place, speed, faster in encounter
    ]
    came, passes = False, False
    for place, speed, faster in encounter:
        came = place == "behind" or (came and place == "beside")
        passes |= came and place == "beside" and speed > 0 and faster > 0
    found = verify(Trace("t", 1.0, {"c": "cyclist"}, tuple(states)), compiled(name)).violations
    assert ("lateral_gap" in {one.rule for one in found}) is passes


@pytest.mark.parametrize("name", ["vienna", "de", "in"])
@pytest.mark.parametrize(
    ("of_ego", "pulls_out"),
    [
        ({}, False),
        ({"speed": 10}, False),
        ({"speed": 10, "lane_change": True}, True),
        ({"speed": 10, "straddling": True}, True),
        ({"speed": 10, "station": {"v": "beside"}}, True),
        ({"speed": 0, "station": {"v": "beside"}}, False),
    ],
)
def test_who_pulls_out_moves_over_itself(name, of_ego, pulls_out):
    side = "left_of" if read(name).rulebook.traffic == "right" else "right_of"
    states = (
        {"station": {"v": "behind"}, "lateral": {"v": "same_lane"}},
        {
            "station": {"v": "behind"},
            "lateral": {"v": side},
            "being_overtaken": True,
            **of_ego,
        },
    )
    found = verify(Trace("t", 1.0, {"v": "car"}, states), compiled(name)).violations
    assert ("pulling_out" in {one.rule for one in found}) is pulls_out


@pytest.mark.parametrize("step", STEPS, ids=str)
@of_each_end
def test_who_cuts_in_gives_three_seconds(step, ends):
    judge = book_on("vienna", "following_distance", ends, step)
    close = {"station": {"v": "behind"}, "safe_gap": {"v": False}}
    beside, ahead = ({**close, "lateral": {"v": one}} for one in ("left_of", "same_lane"))
    far = {**ahead, "safe_gap": {"v": True}}
    three = int(3 / step)

    def blamed(*states):
        return bool(violations(judge, states, {"v": "car"}))

    assert not blamed(beside, *[ahead] * (three + 1), far)
    assert blamed(beside, *[ahead] * (three + 2), far)
    assert blamed(beside, {**ahead, "lane_change": True}, far)
    assert blamed(beside, {**ahead, "straddling": True}, far)
    assert blamed(ahead, far)
    assert blamed(far, ahead, far)


@pytest.mark.parametrize("step", STEPS, ids=str)
@of_each_end
def test_a_moment_away_from_the_kerb_is_no_straying(step, ends):
    judge = book_on("vienna", "keep_near_side", ends, step)
    near, far = ({"lanes": "two_lanes", "lane": one} for one in ("kerb_lane", "far_lane"))
    five = int(5 / step)
    assert not violations(judge, [far, near])
    assert not violations(judge, [near, *[far] * (five - 1), {**far, "overtaking": True}])
    assert not violations(judge, [near, *[far, {**far, "dense_all_lanes": True}] * 3, near])
    assert violations(judge, [near, *[far] * five, near])


@pytest.mark.parametrize("name", ["vienna", "de", "se", "fr", "gb"])
def test_who_comes_in_over_the_middle_has_time_for_each_lane(name):
    judge = book_on(name, "keep_near_side", "stutter", Fraction(1))
    near, middle, far = (
        {"lanes": "three_or_more_lanes", "lane": one, "limit": 100}
        for one in ("kerb_lane", "middle_lane", "far_lane")
    )
    assert not violations(judge, [near, *[far] * 4, *[middle] * 5, near])
    assert violations(judge, [near, *[far] * 5, *[middle] * 3, near])
    assert violations(judge, [near, *[far] * 4, *[middle] * 6, near])


EMERGENCY = sorted({*NATIONAL} - {"un-r79", "un-r157"})  # those are about one system of a car


@pytest.mark.parametrize("name", EMERGENCY)
def test_a_duty_that_still_runs_at_the_end_is_not_lost_yet(name):
    judge = book_on(name, "emergency_vehicles", "stutter", Fraction(1, 10))
    states = [{}] * 20 + [{"emergency_vehicle_near": True, "speed": 30}] * 10
    assert [one.step for one in violations(judge, states)] == [None]
    cleared = {"emergency_vehicle_near": True, "way_cleared": True}
    assert not violations(judge, [*states, cleared])
    late = violations(judge, [*states, *states[-1:] * 60])
    assert [one.step for one in late] != [None]
