"""The participants that count for ego."""

from dataclasses import replace
from math import pi, radians, sin

import numpy as np
import pytest

from rulec.extraction.drives import Drives
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording, straight
from support.generators.random_recordings import lanes


def relevant(*others, ego=None, **thresholds):
    """Ids of those that count, with the states in which they do."""
    ego = ego or steady(7, 0, 0)
    context = context_of(recording(lanes(2), [ego, *others]), **thresholds)
    return {
        body.id: flags.tolist()
        for body, flags in zip(context.tracks.participants, context.relevant, strict=True)
    }


@pytest.mark.parametrize(("x", "counts"), [(153.9, True), (154.1, False), (-99, True)])
def test_along_the_road_distance_between_bodies_counts(x, counts):
    assert ("8" in relevant(steady(8, x, 0))) is counts


def test_the_distance_is_a_threshold_and_changes_with_time():
    # 40 m ahead between bodies, and 5 m farther away in each state
    assert relevant(steady(8, 44, 0, speed=20), near_m=51) == {"8": [True, True, True, False]}


@pytest.mark.parametrize(
    ("kind", "y", "counts"),
    [("car", -3.2, False), ("pedestrian", -3.2, True), ("bicycle", -9, True), ("car", -1, True)],
)
def test_beside_the_road_only_vulnerable_users_count(kind, y, counts):
    body = steady(8, 30, y, kind=kind, width=0.6)
    assert ("8" in relevant(body)) is counts


def test_beside_the_road_there_is_a_limit():
    # Lanes from -2 m on: 8 m beside them is -10 m
    assert "8" in relevant(steady(8, 30, -10.1, kind="pedestrian", width=0.6))
    assert "8" not in relevant(steady(8, 30, -10.5, kind="pedestrian", width=0.6))


def test_oncoming_vehicles_beside_the_lanes_count_if_they_ever_move():
    assert "8" in relevant(steady(8, 90, 8, speed=-5))
    assert "8" not in relevant(steady(8, 90, 8, speed=-0.1, heading=pi))
    assert "8" not in relevant(steady(8, 90, 8, speed=5))


@pytest.mark.parametrize(
    ("kind", "y", "heading", "counts"),
    [
        ("train", -3.6, 0.0, True),
        ("train", 7.9, 0.0, True),
        ("train", -6.0, 0.0, False),
        ("train", -13.6, 1.2, False),
        ("bus", -3.6, 0.0, False),
    ],
)
def test_trams_on_tracks_next_to_the_lanes_count(kind, y, heading, counts):
    """The lanes reach from y = -2 to 6; a railway farther beside the road is none of its own."""
    for speed in (0.0, 8.0):
        body = steady(8, 40, y, kind=kind, width=2.6, length=20.0, speed=speed, heading=heading)
        assert ("8" in relevant(body)) is counts


@pytest.mark.parametrize(
    ("y", "heading", "lamp", "counts"),
    [
        (-3.6, 0.0, "left_indicator", True),
        (7.6, 0.0, "right_indicator", True),
        # It only arrives; it parks; it is far off the lanes; it faces ego
        (-3.6, 0.0, "right_indicator", False),
        (-3.6, 0.0, None, False),
        (-5.6, 0.0, "left_indicator", False),
        (-3.6, pi, "left_indicator", False),
    ],
)
def test_a_bus_that_signals_to_come_in_from_its_bay_counts(y, heading, lamp, counts):
    """The lanes reach from y = -2 to 6; the bus signals in its second state, and in no other."""
    body = steady(8, 40, y, kind="bus", width=2.6, length=12.0, speed=0.0, heading=heading)
    lit = {1: frozenset({lamp} if lamp else ())}
    body = replace(body, lamps={**dict.fromkeys(range(4), frozenset()), **lit})
    assert relevant(body).get("8") == ([False, True, True, True] if counts else None)
    # Both are hazard lights; and one that drives there is on a way of its own
    hazards = replace(body, lamps={1: frozenset({"left_indicator", "right_indicator"})})
    assert "8" not in relevant(hazards)
    assert "8" not in relevant(replace(steady(8, 40, y, kind="bus", width=2.6), lamps=body.lamps))


def beside(*others, y=8.0):
    """Whether one counts that faces ego; the lane of the other direction has its middle at 8."""
    road = [*lanes(2), straight(9, 300, -100, 8.0)]
    context = context_of(recording(road, [steady(7, 0, 0), *others]))
    return "8" in [
        body.id
        for body, flags in zip(context.tracks.participants, context.relevant, strict=True)
        if flags.any()
    ]


@pytest.mark.parametrize(("y", "counts"), [(8.0, True), (8.4, True), (8.9, False), (12.0, False)])
def test_one_that_always_waits_in_the_other_lane_counts_and_one_that_parks_does_not(y, counts):
    assert beside(steady(8, 60, y, speed=0, heading=pi)) is counts
    # The wrong way round in that lane, or a box that never was a driver's, is no traffic
    assert not beside(steady(8, 60, y, speed=0))
    assert not beside(steady(8, 60, y, speed=0, heading=pi, standing=True))


@pytest.mark.parametrize("lamp", ["hazard_lights", "blue_light", "doors", None])
def test_one_that_always_stands_with_lamps_on_or_doors_open_counts(lamp):
    bus = steady(8, 60, 9.5, speed=0, heading=pi, kind="bus")
    lit = frozenset({lamp} if lamp else {"brake_light"})
    assert beside(replace(bus, lamps=dict.fromkeys(range(4), lit))) is (lamp is not None)


def test_ego_never_counts_for_itself():
    assert relevant() == {}
    (drive,) = Drives(recording(lanes(1), [steady(7, 0, 0)]), "right").of("7")
    assert drive.trace.objects == {}


def crossing(heading, elsewhere=True):
    """Does a car count whose front reaches 0.5 m into ego's lane, from another road or its own?"""
    # A car of 4 m that stands in a side road, the middle 2 m beside the reach into the lane
    reach = 0.5 + (-2 - 2) if abs(sin(heading)) > 0.5 else -2.0
    waits = steady(8, 40, reach, speed=0, heading=heading)
    found = recording(lanes(2), [steady(7, 0, 0), waits])
    flags = np.array([[False] * 4, [elsewhere] * 4])
    context = context_of(found, elsewhere=flags)
    return bool(context.relevant.any())


def test_who_waits_in_a_side_road_is_not_on_egos():
    assert not crossing(pi / 2)
    assert not crossing(radians(60))
    # Who joins ego's road, or came along it and stands across, is on it
    assert crossing(radians(20))
    assert crossing(pi / 2, elsewhere=False)
