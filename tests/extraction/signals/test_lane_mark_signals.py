"""Signals of road marks."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals import lane_mark_signals
from support.builders.drive_contexts import context_of, steady, told_on_both_sides
from support.builders.recordings import recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import possible_in, possibly_said, unknown_in, values_of
from support.words import words_of

# From the right lane to the left one, at 10 m/s; the middle crosses the mark before state 2
CHANGE = {0: (0, 0), 1: (5, 1.5), 2: (10, 2.5), 3: (15, 4)}


def marks(y, right=None, left=None, count=2, route=("1",)):
    """The signals of marks in the first state; marks are those on both lanelets beside a line."""
    road = lanes(count)
    road[0] = replace(road[0], left_mark=right)
    if count > 1:
        road[1] = replace(road[1], right_mark=left)
    signals = words_of(lane_mark_signals)(context_of(recording(road, [steady(7, 0, y)]), route))
    known = {name: possibly_said(signals, name)[0].item() for name in signals.world}
    return known, {name: unknown_in(signals, name)[0].item() for name in signals.world}


def test_a_map_without_marks_says_nothing_of_them():
    assert marks(0) == ({}, {})


@pytest.mark.parametrize(
    ("right", "left", "marked", "unknown"),
    [
        ("solid", "solid", True, False),
        ("none", "broken", True, False),
        ("none", "none", False, False),
        ("none", None, True, False),
    ],
)
def test_lanes_are_marked_by_any_line_between_them(right, left, marked, unknown):
    known, where = marks(0, right, left)
    assert known["marked_lanes"] is marked
    assert where["marked_lanes"] is unknown


def test_an_only_lane_has_no_marks_between_lanes():
    assert marks(0, "solid", count=1)[0]["marked_lanes"] is False


def test_a_line_between_lanes_without_any_mark_leaves_it_unknown():
    road = lanes(3)
    road[0] = replace(road[0], left_mark="broken")
    signals = words_of(lane_mark_signals)(context_of(recording(road, [steady(7, 0, 0)])))
    assert unknown_in(signals, "marked_lanes").all()


@pytest.mark.parametrize(("y", "solid"), [(0, False), (1.2, False), (1.4, True), (2.8, False)])
def test_a_solid_line_lies_under_ego_from_thirty_centimetres_on(y, solid):
    assert marks(y, "solid", "solid")[0]["on_solid_line"] is solid


@pytest.mark.parametrize(
    ("ys", "mark", "told"),
    [
        # Clear of the line at 2 m on one side, then on the other: only when it lay on it is unknown
        ((0, 0, 1, 2, 3, 4, 4), "solid", "FFFTFFF"),
        ((4, 4, 3, 2, 1, 0, 0), "solid", "FFFTFFF"),
        ((0, 0, 1, 2, 3, 4, 4), "broken", "FFFFFFF"),
        # Back again, not yet clear of it, or seen first beside it
        ((0, 0, 1, 2, 1, 0, 0), "solid", "FF???FF"),
        ((0, 0, 1, 2, 3, 3, 3), "solid", "FF?????"),
        ((1, 1, 1, 2, 3, 4, 4), "solid", "?????FF"),
    ],
)
def test_who_gets_over_a_solid_line_has_been_on_it_however_badly_places_are_known(ys, mark, told):
    road = lanes(2)
    road = [replace(road[0], left_mark=mark), replace(road[1], right_mark=mark)]
    ego = vehicle(7, {k: (8.0 * k, float(y)) for k, y in enumerate(ys)})
    found = words_of(lane_mark_signals)(context_of(recording(road, [ego]), place_error_m=0.4))
    values = np.where(values_of(found, "on_solid_line"), "T", "F")
    assert "".join(np.where(unknown_in(found, "on_solid_line"), "?", values)) == told


def test_who_is_parked_on_a_line_does_not_cross_it():
    road = lanes(2)
    road[0] = replace(road[0], left_mark="solid")
    parked, drives = (steady(7, 0, 1.4, speed=mps) for mps in (0, 10))
    found = [
        words_of(lane_mark_signals)(context_of(recording(road, [ego]))) for ego in (parked, drives)
    ]
    assert [bool(values_of(x, "on_solid_line")[0]) for x in found] == [False, True]


def test_who_stands_on_a_line_from_the_beginning_on_has_not_been_seen_to_cross_it():
    road = lanes(2)
    road[0] = replace(road[0], left_mark="solid")
    # Its box wanders by 0.4 m before it moves off; who drives slowly is 1.5 m on after a state
    parked = vehicle(7, {0: (50, 1.4), 1: (50.4, 1.4), 2: (50, 1.4), 3: (56, 1.4)}, speed=0.1)
    creeps = vehicle(7, {k: (50 + 1.5 * k, 1.4) for k in range(4)}, speed=3.0)
    found = [
        words_of(lane_mark_signals)(context_of(recording(road, [ego]))) for ego in (parked, creeps)
    ]
    assert [unknown_in(x, "on_solid_line").tolist() for x in found] == [
        [True, True, True, False],
        [False] * 4,
    ]
    assert all(possible_in(x, "on_solid_line").all() for x in found)


@pytest.mark.parametrize(("right", "left"), [("broken", "solid"), ("solid", "broken")])
def test_of_two_lines_which_is_on_ego_s_side_is_unknown_for_one_first_seen_on_them(right, left):
    known, unknown = marks(1.5, right, left)
    assert (known["on_solid_line"], unknown["on_solid_line"]) == (True, False)
    assert unknown["broken_on_own_side"]


def test_ego_is_in_a_lane_that_there_is():
    # The third lane begins at 200 m: before it ego, on whose place it would be, is on the second
    row = [straight(k, 0, 200, y=4 * (k - 1), successors=(k + 10,), **beside(k, 2)) for k in (1, 2)]
    later = [straight(k + 10, 200, 400, y=4 * (k - 1), **beside(k, 3, 10)) for k in (1, 2, 3)]
    found = recording([*row, *later], [vehicle(7, {0: (100, 8), 1: (300, 8)})])
    assert context_of(found, ("1", "11")).ego_lane.tolist() == [1, 2]


def beside(k, count, more=0):
    return {
        "left_of": k + 1 + more if k < count else None,
        "right_of": k - 1 + more if k > 1 else None,
    }


def at_a_shoulder(linked):
    """Lanes at y = 0 and 4, and a hard shoulder at y = -4; all lines are solid."""
    solid = {"left_mark": "solid", "right_mark": "solid"}
    return [
        straight(1, 0, 600, left_of=2, right_of=3 if linked else None, **solid),
        straight(2, 0, 600, 4, right_of=1, **solid),
        straight(3, 0, 600, -4, left_of=1 if linked else None, types={"shoulder"}, **solid),
    ]


def on_solid_lines(road, body, route=("1",), step_s=0.5):
    """Whether ego is on a solid line, by state; the same in the mirror."""
    found = recording(road, [body], step_s=step_s)
    return told_on_both_sides(words_of(lane_mark_signals), found, route)["on_solid_line"]


@pytest.mark.parametrize("route", [("1",), ("3",)])
@pytest.mark.parametrize("linked", [True, False])
@pytest.mark.parametrize(("step_s", "mps"), [(0.5, 10.0), (0.1, 30.0)])
def test_other_rules_say_who_may_cross_the_line_towards_a_shoulder(route, linked, step_s, mps):
    n_steps = round(3 / step_s)
    out = np.interp(np.arange(n_steps + 1) / n_steps, (0.1, 0.9), (0.0, 4.0))

    def goes(ys):
        places = {k: (20 + mps * step_s * k, y) for k, y in enumerate(ys.tolist())}
        return on_solid_lines(at_a_shoulder(linked), vehicle(7, places, speed=mps), route, step_s)

    assert set(goes(-out)) == {"False", "?"}
    assert set(goes(out - 4)) == {"False", "?"}
    if route == ("1",):
        # The line between two lanes is another matter
        assert "True" in goes(out)


def test_a_lane_beyond_the_road_s_edge_is_no_shoulder():
    """Who drives onto it crosses a line between lanes, though the map does not link them."""
    road = at_a_shoulder(linked=False)
    assert on_solid_lines(road, steady(7, 20, -1.6)) == ["?"] * 4
    road[2] = replace(road[2], types=frozenset())
    assert on_solid_lines(road, steady(7, 20, -1.6)) == ["True"] * 4
