"""Relations agree with a brute-force look at polygons, on a straight road."""

import pytest
import shapely
from hypothesis import given

from rulec.extraction.drives import Drive, Drives
from rulec.extraction.traffic_thresholds import USUAL
from rulec.vocabulary.partial_values import Interval
from support.generators.random_recordings import STEP_S, scenes


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
    if ego.centroid.y <= wide.bounds[1]:
        return station, "right_of"
    return station, "left_of" if ego.centroid.y >= wide.bounds[3] else "same_lane"


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
        for number, state in enumerate(drive.trace.states):
            step = round(drive.start_s / STEP_S) + number
            ego = bodies[drive.ego, step]
            for other in state.get("station", {}):
                body = bodies[other.partition("_")[0], step]
                expected = seen_from(body, ego, lanes)
                assert (state["station"][other], state["lateral"][other]) == expected
                gap = shadow(body, 0).distance(shadow(ego, 0))
                beside = shadow(body, 1).distance(shadow(ego, 1))
                for name, distance in (("gap", gap), ("lateral_gap", beside)):
                    low, high = bounds(state[name][other])
                    assert low == pytest.approx(max(distance - 0.05, 0), abs=0.011) or distance == 0
                    assert low - 0.006 <= distance <= high + 0.006
                    assert high <= distance + 0.061


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
