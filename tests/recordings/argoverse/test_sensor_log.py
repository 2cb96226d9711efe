"""Sensor logs, written here and thought out by hand: frames, sweeps, sizes, riders."""

from math import pi

import numpy as np
import pytest

from rulec import read_recording
from rulec.diagnostics import RulecError
from rulec.extraction.tracks.source_tolerances import tolerances_of
from support.builders.argoverse_files import LOG_ID, box, pose, write_log

SWEEPS = [1_000_000_000 + 100_000_000 * k + jitter for k, jitter in enumerate((0, -300_000, 0))]
NORTH = pi / 2


def poses(angle=NORTH):
    """Ego's rear axle at (20, -5), and a metre farther north each time; and in between."""
    moments = sorted([*SWEEPS, SWEEPS[0] + 50_000_000])
    return [pose(m, 20.0, -5.0 + (m - SWEEPS[0]) / 1e8, angle) for m in moments]


def car(places, name="car", category="REGULAR_VEHICLE", **more):
    return [box(SWEEPS[k], name, category, x, y, **more) for k, (x, y) in places.items()]


AHEAD = car({0: (10, 2), 1: (9, 2), 2: (8, 2)})
"""It stands: ego nears it."""


def body(found, name):
    return next(x for x in found.participants if x.id == name)


def test_a_log_is_recognised_by_its_name_or_its_folder(tmp_path):
    path = write_log(tmp_path, AHEAD, poses())
    found = read_recording(path)
    assert found.name == read_recording(tmp_path).name == LOG_ID
    assert (found.form, found.side, found.country) == ("Argoverse 2 sensor log", "right", "USA")
    assert (found.ego, found.step_s) == ("AV", 0.1)
    assert tolerances_of(found).place_m == 0.15


def test_boxes_come_from_egos_frame_to_the_citys(tmp_path):
    states = body(read_recording(write_log(tmp_path, AHEAD, poses())), "car").states
    # Ego looks north: 10 m ahead is y, 2 m to its left is less x
    assert [(s.x, s.y) for s in states.values()] == [
        pytest.approx((18.0, y)) for y in (5.0, 4.997, 5.0)
    ]
    assert states[0].heading == pytest.approx(NORTH)
    assert states[2].speed == pytest.approx(0.0, abs=0.05)


def test_a_box_may_be_turned_in_egos_frame(tmp_path):
    boxes = car({0: (10, 0), 1: (10, 0), 2: (10, 0)}, angle=pi)
    found = body(read_recording(write_log(tmp_path, boxes, poses(0.0))), "car")
    assert abs(found.states[0].heading) == pytest.approx(pi)
    assert (found.states[0].x, found.states[0].y) == pytest.approx((30.0, -5.0))


def test_a_slope_shortens_a_way_in_the_plane(tmp_path):
    # Ego drives up 60 degrees: turned about y by -60
    up = {"qw": float(np.cos(pi / 6)), "qx": 0.0, "qy": float(-np.sin(pi / 6)), "qz": 0.0}
    slope = [pose(m, 20.0, -5.0) | up for m in SWEEPS]
    found = body(read_recording(write_log(tmp_path, AHEAD[:1], slope)), "car")
    assert (found.states[0].x, found.states[0].y) == pytest.approx((25.0, -3.0))


def test_ego_is_its_body_and_not_its_rear_axle(tmp_path):
    ego = body(read_recording(write_log(tmp_path, AHEAD, poses())), "AV")
    assert [(s.x, s.y) for s in ego.states.values()][::2] == [
        pytest.approx((20.0, -3.66)),
        pytest.approx((20.0, -1.66)),
    ]
    assert ego.states[1].speed == pytest.approx(10.0)
    assert np.ptp(ego.outlines[0], axis=0) == pytest.approx([2.0, 4.877])
    assert ego.type == "car"


def test_ego_in_the_annotations_is_not_there_twice(tmp_path):
    own = car(dict.fromkeys(range(3), (0, 0)), "me", "EGO_VEHICLE", length_m=5.0, width_m=2.1)
    found = read_recording(write_log(tmp_path, [*AHEAD, *own], poses()))
    assert (found.ego, [x.id for x in found.participants]) == ("me", ["me", "car"])
    assert np.ptp(body(found, "me").outlines[0], axis=0) == pytest.approx([2.1, 5.0])
    assert body(found, "me").states[0].y == pytest.approx(-3.66)


def test_sizes_are_those_of_the_boxes(tmp_path):
    boxes = car({0: (10, 2), 1: (9, 2)}, length_m=6.0, width_m=2.0)
    boxes += car({2: (8, 2)}, length_m=5.0, width_m=2.0)
    found = body(read_recording(write_log(tmp_path, boxes, poses(0.0))), "car")
    assert np.ptp(found.outlines[2], axis=0) == pytest.approx([6.0, 2.0])


def test_who_is_away_for_a_sweep_has_no_state_there(tmp_path):
    found = read_recording(
        write_log(tmp_path, car({0: (10, 2), 2: (8, 2)}) + car({1: (3, 3)}, "x"), poses())
    )
    assert list(body(found, "car").states) == [0, 2]
    assert list(body(found, "x").states) == [1]


@pytest.mark.parametrize(
    ("seen", "mps", "left"),
    [
        # Between two sweeps that are a second apart, or more
        ({0, 10, 20}, 5.0, range(21)),
        ({0, 11, 20}, 5.0, {0, *range(11, 21)}),
        # It stands, behind something; or was in sight for a while
        ({5}, 0.0, range(21)),
        (range(5, 9), 6.0, range(5, 9)),
        ((), 5.0, ()),
    ],
)
def test_boxes_without_points_are_guesses(tmp_path, seen, mps, left):
    moments = [1_000_000_000 + 100_000_000 * k for k in range(21)]
    boxes = [
        box(m, "car", "REGULAR_VEHICLE", 10 + mps * k / 10, 2, num_interior_pts=int(k in seen))
        for k, m in enumerate(moments)
    ]
    found = read_recording(write_log(tmp_path, boxes, [pose(m, 20.0, -5.0) for m in moments]))
    there = [body for body in found.participants if body.id == "car"]
    assert [sorted(body.states) for body in there] == ([sorted(left)] if left else [])


@pytest.mark.parametrize(
    ("category", "types"),
    [
        ("REGULAR_VEHICLE", ("car", "vehicle", "road_user", "obstacle")),
        ("LARGE_VEHICLE", ("vehicle", "road_user", "obstacle")),
        ("BOX_TRUCK", ("truck", "vehicle", "road_user", "obstacle")),
        ("SCHOOL_BUS", ("bus", "vehicle", "road_user", "obstacle")),
        ("VEHICULAR_TRAILER", ("road_user", "obstacle")),
        ("WHEELED_RIDER", ("light_rider", "vulnerable_user", "road_user", "obstacle")),
        ("OFFICIAL_SIGNALER", ("pedestrian", "vulnerable_user", "road_user", "obstacle")),
        ("BICYCLE", ("obstacle",)),
        ("CONSTRUCTION_CONE", ("obstacle",)),
        ("DOG", ("obstacle",)),
    ],
)
def test_types_of_categories(tmp_path, category, types):
    found = read_recording(write_log(tmp_path, car({0: (9, 2)}, category=category), poses()))
    assert body(found, "car").object_types == types


@pytest.mark.parametrize("category", ["SIGN", "STOP_SIGN"])
def test_boards_are_nobody_and_no_signs(tmp_path, category):
    boards = car({0: (9, 2)}, "board", category)
    found = read_recording(write_log(tmp_path, [*AHEAD, *boards], poses()))
    assert "board" not in {x.id for x in found.participants}
    assert not any(x.signs for x in found.lanelets.values())


def test_a_rider_and_its_cycle_are_one_while_it_rides(tmp_path):
    rider = car({0: (9, 2), 1: (9, 2)}, "rider", "BICYCLIST", length_m=0.8, width_m=0.7)
    cycle = car(
        {0: (9.2, 2), 1: (9.2, 2), 2: (9.2, 2)}, "cycle", "BICYCLE", length_m=1.8, width_m=0.5
    )
    elsewhere = car({0: (9.2, 4)}, "other", "BICYCLE")
    boxes = [*rider, *cycle, *elsewhere]
    found = read_recording(write_log(tmp_path, boxes, poses(0.0)))
    assert list(body(found, "rider").states) == [0, 1]
    # As long as the cycle and as wide as the rider
    assert np.ptp(body(found, "rider").outlines[0], axis=0) == pytest.approx([1.8, 0.7])
    assert list(body(found, "cycle").states) == [2]
    assert list(body(found, "other").states) == [0]


def test_a_cycle_that_is_ridden_all_the_time_is_nobody_else(tmp_path):
    boxes = car({0: (9, 2)}, "rider", "MOTORCYCLIST") + car({0: (9, 2)}, "cycle", "MOTORCYCLE")
    found = read_recording(write_log(tmp_path, boxes, poses()))
    assert [x.id for x in found.participants] == ["AV", "rider"]


def log_of(moments):
    boxes = [box(m, "car", "REGULAR_VEHICLE", 9, 2) for m in moments]
    return boxes, [pose(m, 20.0, -5.0) for m in moments]


@pytest.mark.parametrize(
    ("apart_ms", "step_s", "steps"),
    [
        ((100, 100.2, 99.8), 0.1, [0, 1, 2, 3]),
        ((100, 200, 100, 100), 0.1, [0, 1, 3, 4, 5]),
        # One is late, and so are all behind it: of one grid, each is off by 0.02 s
        ((*[100] * 9, 140, *[100] * 9), 0.1, [*range(20)]),
        ((200, 199, 201), 0.2, [0, 1, 2, 3]),
        ((500, 500), 0.5, [0, 1, 2]),
    ],
)
def test_sweeps_lie_on_a_grid(tmp_path, apart_ms, step_s, steps):
    moments = [10**9 + round(1e6 * sum(apart_ms[:k])) for k in range(len(apart_ms) + 1)]
    found = read_recording(write_log(tmp_path, *log_of(moments)))
    assert found.step_s == step_s
    assert list(body(found, "car").states) == steps


def test_uneven_sweeps_are_refused(tmp_path):
    moments = [10**9 + round(1e6 * m) for m in (0, 70, 200, 330, 400, 470, 600)]
    with pytest.raises(RulecError) as caught:
        read_recording(write_log(tmp_path, *log_of(moments)))
    assert "its times are uneven" in caught.value.diagnostics[0].message


BAD = {
    "twice": ([*AHEAD, AHEAD[1]], poses(), "`car` is twice in one sweep"),
    "category": (car({0: (9, 2)}, category="UFO"), poses(), "`category` is `UFO`"),
    "size": (car({0: (9, 2)}, length_m=0.0), poses(), "a box is 0 m by 1.9 m"),
    "large": (car({0: (9, 2)}, width_m=1e4), poses(), "a box is 4.5 m by 10000 m"),
    "nan": (car({0: (np.nan, 2)}), poses(), "`tx_m` is nan"),
    "turn": (car({0: (9, 2)}, qw=0.0, qz=0.0), poses(), "its quaternion is 0"),
    "no pose": (AHEAD, poses()[:2], "it has no pose at"),
    "ego": (car({0: (9, 2)}, "AV"), poses(), "somebody else is called `AV`"),
    "years": (log_of([0, 10**8, 2 * 10**8, 10**18])[0], poses(), "are spread over"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_is_refused(tmp_path, name):
    boxes, own, why = BAD[name]
    path = write_log(tmp_path, boxes, own)
    with pytest.raises(RulecError) as caught:
        read_recording(path)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    assert why in found.message
    assert found.place.file.startswith(str(tmp_path))


@pytest.mark.parametrize("gone", ["city_SE3_egovehicle.feather", "map"])
def test_what_is_missing_beside_it_is_named(tmp_path, gone):
    path = write_log(tmp_path, AHEAD, poses())
    for file in (tmp_path / gone).glob("*") if gone == "map" else [tmp_path / gone]:
        file.unlink()
    with pytest.raises(RulecError) as caught:
        read_recording(path)
    assert "beside it" in caught.value.diagnostics[0].message
