"""Relations agree with a brute-force look at polygons, on a straight road."""

from dataclasses import replace

import pytest
import shapely
from hypothesis import given

from rulec.extraction.drives import Drive, Drives
from rulec.extraction.signals.map import lanes_ahead
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.traffic_thresholds import USUAL
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording
from support.generators.random_recordings import STEP_S, lanes, scenes
from support.signal_arrays import said, unknown_in, values_of
from support.words import words_of

PLACE_M = 0.05
"""Places of a recording made by hand are as good."""


def lane_polygons(found):
    return [
        shapely.Polygon([*one.right.tolist(), *one.left[::-1].tolist()])
        for one in found.lanelets.values()
        if "crosswalk" not in one.types
    ]


def shadow(polygon, axis):
    """What a polygon covers of an axis."""
    low, high = polygon.bounds[axis], polygon.bounds[axis + 2]
    return shapely.LineString([(low, 0), (high, 0)])


def seen_from(body, ego, lanes):
    """Station and lateral of a body as it is seen from the other one."""
    along = shadow(body, 0), shadow(ego, 0)
    if along[0].distance(along[1]) > 0:
        station = "behind" if ego.centroid.x < body.centroid.x else "in_front_of"
    else:
        station = "beside"
    length = body.bounds[2] - body.bounds[0]
    width = body.bounds[3] - body.bounds[1]
    enough = min(USUAL.touching_m, width / 2) * length
    touched = [lane for lane in lanes if lane.intersection(body).area > enough]
    wide = shapely.union_all(touched) if touched else body
    on_mark = not covers(min(lanes, key=ego.centroid.distance), body)
    if on_mark and shadow(body, 1).distance(shadow(ego, 1)) > USUAL.touching_m:
        wide = body
    if in_the_way(min(lanes, key=ego.centroid.distance), body, ego):
        return station, "same_lane"
    if ego.centroid.y <= wide.bounds[1]:
        return station, "right_of"
    return station, "left_of" if ego.centroid.y >= wide.bounds[3] else "same_lane"


def in_the_way(lane, body, ego):
    """Does a body overlap ego's across the road, and ego's lane at all?"""
    overlap = min(body.bounds[3], ego.bounds[3]) - max(body.bounds[1], ego.bounds[1])
    inside = min(body.bounds[3], lane.bounds[3]) - max(body.bounds[1], lane.bounds[1])
    return overlap > USUAL.touching_m and inside > 0


def covers(lane, body):
    """Does a body keep within a lane, but for so little that it is in no other?"""
    low, high = lane.bounds[1] - USUAL.touching_m, lane.bounds[3] + USUAL.touching_m
    return low <= body.bounds[1] and body.bounds[3] <= high


def bounds(value):
    return (value.low, value.high) if isinstance(value, Interval) else (value, value)


@given(scenes())
def test_who_is_where(found):
    lanes = lane_polygons(found)
    bodies = {
        (one.id, step): shapely.Polygon(outline)
        for one in found.participants
        for step, outline in one.outlines.items()
    }
    told = Drives(found, "right")
    for drive in (one for ego in told.egos() for one in told.of(ego)):
        if not isinstance(drive, Drive):
            continue
        seen = set()
        for number, state in enumerate(drive.trace.states):
            step = round(drive.start_s / STEP_S) + number
            ego = bodies[drive.ego, step]
            for other in state.get("station", {}):
                body = bodies[other.partition("_")[0], step]
                expected = seen_from(body, ego, lanes)
                # Ego may be passing who is beside it when it is first seen
                at_first = other not in seen and expected[0] == "beside"
                seen.add(other)
                (low, _, high, _), (begin, _, end, _) = body.bounds, ego.bounds
                level = min(abs(low - end), abs(begin - high)) <= PLACE_M
                told_one = state["station"][other]
                assert told_one == (UNKNOWN if at_first else expected[0]) or (
                    level and told_one == UNKNOWN
                )
                assert state["lateral"][other] in (expected[1], UNKNOWN)
                gap = shadow(body, 0).distance(shadow(ego, 0))
                beside = shadow(body, 1).distance(shadow(ego, 1))
                for name, distance in (("gap", gap), ("lateral_gap", beside)):
                    low, high = bounds(state[name][other])
                    assert low == pytest.approx(max(distance - 0.05, 0), abs=0.011) or distance == 0
                    assert low - 0.006 <= distance <= high + 0.006
                    assert high <= distance + 0.061


def sides(*ys, own_y=0.0, name="USA_Peach-1", width=2.0):
    """Where ego is, seen from others 30 m ahead at places across the road; None: unknown.

    Bodies are 2 m wide, the mark of ego's lane is at y = 2.
    """
    others = [steady(20 + k, 30, y, width=width) for k, y in enumerate(ys)]
    found = replace(recording(lanes(2), [steady(7, 0, own_y), *others]), name=name)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found)
    )
    known = ~unknown_in(signals, "lateral")[:, 0]
    told = said(signals, "lateral")[:, 0].tolist()
    return [side if sure else None for side, sure in zip(told, known.tolist(), strict=True)]


EXACT = "DEU_Test-1"


def test_who_is_on_the_mark_and_clear_of_ego_is_not_in_its_lane():
    # They reach 0.5 and 1.6 m into the lane, 0.5 m clear of ego, and not
    assert sides(2.5, 1.4, name=EXACT) == ["right_of", "same_lane"]
    # It is leaving, or coming: less than a quarter of it, 0.2 m, is in ego's way
    assert sides(1.8, name=EXACT) == [None]
    # Where its middle is beyond the mark less than half, and more
    assert sides(2.1, own_y=0.4, name=EXACT) == [None]
    assert sides(2.1, own_y=1.2, name=EXACT) == ["same_lane"]
    # Ego keeps 0.7 m to the right: there is 0.5 m between them
    assert sides(1.8, own_y=-0.7, name=EXACT) == ["right_of"]
    # Who keeps within the lane, but out of ego's way, does not surely drive ahead: a motorcycle
    assert sides(1.5, own_y=-0.9, width=0.8, name=EXACT) == [None]
    assert sides(0.3, own_y=-0.9, width=0.8, name=EXACT) == ["same_lane"]
    # And is on its way out where it reaches beyond it by 0.4 m
    assert sides(2.0, own_y=-0.9, width=0.8, name=EXACT) == ["right_of"]


def test_who_hardly_reaches_in_but_is_in_the_way_of_ego_is_in_its_lane():
    # Ego's own side is at y = 2.9, and theirs, 0.2 m in, at 1.8, and, 0.1 m beyond the mark, at 2.1
    assert sides(2.8, 3.1, own_y=1.9, name=EXACT) == ["same_lane", "right_of"]
    # At y = 2.4 less than half of it is in the way
    assert sides(2.8, 3.1, own_y=1.4, name=EXACT) == [None, "right_of"]


def test_within_the_tolerance_of_places_nobody_knows_who_is_in_the_lane():
    # Video is good to 0.3 m: 0.5 and 0.1 m between them may be 0.2 and 0.4 m
    assert sides(2.5, 2.1, 1.4, 2.65) == [None, None, "same_lane", "right_of"]


def test_a_map_that_lies_off_the_tracks_does_not_tell_lanes():
    """Ten vehicles drive 0.8 m left of the middle of their lanes, ego among them."""
    cars = [steady(20 + k, 20 * k - 60, 0.8, steps=3) for k in range(10) if k != 3]
    ego, other = steady(7, 0, 0.8, steps=3), steady(8, 50, 2.9, steps=3)

    def told(*others):
        found = replace(recording(lanes(2), [ego, other, *others]), name=EXACT)
        context = context_of(found)
        signals = words_of(
            participant_signals, participant_conduct, lanes_ahead, following_signals
        )(context)
        row = [body.id for body in context.tracks.participants].index("8")
        return context.map_offset_m[0], bool(unknown_in(signals, "lateral")[row, 0])

    offset, unknown = told(*cars, steady(40, 80, 4.8))
    assert offset == pytest.approx(0.8)
    assert unknown
    assert told() == (0.0, False)
    # Three in ego's lane tell more than those in others
    beside = [steady(60 + k, 20 * k - 60, 4.0, steps=3) for k in range(12)]
    assert told(*beside, *cars[:3])[0] == pytest.approx(0.8)
    # Nobody is 15 cm off by intention
    few = [steady(20 + k, 20 * k - 60, 0.14, steps=3) for k in range(3)]
    assert told(*few)[0] == 0.0


def test_one_that_stands_and_leaves_room_is_not_followed_too_closely():
    """A cycle rides 0.6 m clear of a car that stands in its lane, and one 0.2 m clear does not."""

    def safe(y):
        cycle = steady(7, 0, y, speed=6.0, width=0.6, kind="bicycle")
        found = recording(lanes(1), [cycle, steady(8, 5, 0.5, speed=0.0)])
        signals = words_of(
            participant_signals, participant_conduct, lanes_ahead, following_signals
        )(context_of(replace(found, name=EXACT)))
        assert said(signals, "lateral")[0, 0] == "same_lane"
        return bool(values_of(signals, "safe_gap")[0, 0])

    assert safe(-1.4)
    assert not safe(-1.0)


@given(scenes())
def test_who_is_there(found):
    """All that have most of themselves on a lane and are near, whenever ego is there."""
    lanes = lane_polygons(found)
    told = Drives(found, "right")
    for drive in (one for ego in told.egos() for one in told.of(ego)):
        if not isinstance(drive, Drive):
            continue
        first = round(drive.start_s / STEP_S)
        own = next(one for one in found.participants if one.id == drive.ego)
        for other in found.participants:
            for number, state in enumerate(drive.trace.states):
                outline = other.outlines.get(first + number)
                if outline is None or other.id == drive.ego:
                    continue
                body = shapely.Polygon(outline)
                ego = shapely.Polygon(own.outlines[first + number])
                if shadow(body, 0).distance(shadow(ego, 0)) > USUAL.near_m:
                    continue
                if any(lane.intersection(body).area > 0.9 * body.area for lane in lanes):
                    named = {one.partition("_")[0] for one in state["station"]}
                    assert other.id in named
