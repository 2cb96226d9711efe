"""SUMO's floating-car data become recordings: places, sizes, times, and who they are."""

import random
import re
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec import read_recording
from rulec.extraction.tracks.source_tolerances import tolerances_of
from rulec.recordings.sumo.vehicle_types import CLASSES, read_vehicle_types, vehicle_type
from rulec.recordings.track import rectangles
from rulec.scenario.recorded.junction_lanelets import junction_lanelets
from support.builders.sumo_files import body, data, moment, written


def read(folder, *moments, **more):
    return read_recording(written(folder, data(*moments), **more))


def only(recording):
    (one,) = recording.participants
    return one


@pytest.mark.parametrize(
    ("angle", "heading", "centre"),
    [
        (0.0, pi / 2, (50.0, 8.0)),
        (90.0, 0.0, (48.0, 10.0)),
        (180.0, -pi / 2, (50.0, 12.0)),
        (270.0, pi, (52.0, 10.0)),
    ],
)
def test_from_the_bumper_to_the_centre(tmp_path, angle, heading, centre):
    """A car of 4 m with its front bumper at (50, 10), and a compass's angle."""
    one = only(read(tmp_path, moment(0, body(x=50, y=10, angle=angle))))
    state = one.states[0]
    assert (state.x, state.y) == pytest.approx(centre)
    assert np.exp(1j * state.heading) == pytest.approx(np.exp(1j * heading))
    corners = one.outlines[0]
    assert corners.mean(axis=0) == pytest.approx(centre)
    long, wide = (4.0, 1.6) if angle in (90.0, 270.0) else (1.6, 4.0)
    assert np.ptp(corners, axis=0) == pytest.approx((long, wide))


@pytest.mark.parametrize(
    ("kind", "element", "expected"),
    [
        ("small", "vehicle", ("car", 4.0, 1.6)),
        ("lorry", "vehicle", ("truck", 10.0, 2.4)),
        ("DEFAULT_VEHTYPE", "vehicle", ("car", 5.0, 1.8)),
        ("DEFAULT_BIKETYPE", "vehicle", ("bicycle", 1.6, 0.65)),
        ("DEFAULT_PEDTYPE", "person", ("pedestrian", 0.215, 0.478)),
        ("bus", "vehicle", ("bus", 12.0, 2.5)),
        ("of my own", "vehicle", ("car", 5.0, 1.8)),
        ("of my own", "person", ("pedestrian", 0.215, 0.478)),
    ],
)
def test_kinds_and_sizes(tmp_path, kind, element, expected):
    """By the file of routes; by SUMO's own types; by the name, if it is that of a class."""
    recording = read(tmp_path, moment(0, body(kind=kind, element=element)))
    one = only(recording)
    size = np.ptp(one.outlines[0], axis=0)
    assert (one.type, *size) == (expected[0], *map(pytest.approx, expected[1:]))
    guessed = kind in ("bus", "of my own")
    assert len(recording.remarks) == guessed
    assert all(f"`{kind}`" in remark for remark in recording.remarks)


def test_every_class_has_a_kind_that_rulebooks_can_have_a_word_for():
    from rulec.recordings.recording import OBSTACLE_TYPES

    assert {one.kind for one in CLASSES.values()} <= set(OBSTACLE_TYPES)


def test_speed_and_acceleration(tmp_path):
    """As the file says; else the change of speed since the step before, 0 at the first."""
    told = body(name="told", speed=10, acceleration=-1.5)
    steps = [moment(0, told, body(speed=10)), moment(0.5, told, body(speed=11))]
    first, second = read(tmp_path, *steps).participants
    assert [x.acceleration for x in first.states.values()] == [-1.5, -1.5]
    assert [x.acceleration for x in second.states.values()] == [0.0, 2.0]
    assert [x.speed for x in second.states.values()] == [10.0, 11.0]


def test_speeds_that_are_left_out_follow_from_places(tmp_path):
    """As SUMO leaves them out with --fcd-output.attributes; one that is alone has none."""

    def rows(*places):
        return [moment(k / 2, without_speed(body(x=x))) for k, x in enumerate(places)]

    one = only(read(tmp_path, *rows(20, 25, 30, 30, 30)))
    assert [x.speed for x in one.states.values()] == [10, 10, 5, 0, 0]
    assert only(read(tmp_path, *rows(20))).states[0].speed == 0
    # Across a hole none is faster
    there = [*rows(20, 25), moment(4, without_speed(body(x=90))), moment(4.5, body(x=95, speed=7))]
    speeds = [[x.speed for x in one.states.values()] for one in read(tmp_path, *there).participants]
    assert speeds == [[10, 10], [10, 7]]


def test_where_speeds_are_left_out_places_tell_them_to_within_their_rounding(tmp_path):
    steps = [moment(k / 2, body(x=20 + 5 * k)) for k in range(9)]
    told, derived = (
        read(tmp_path, *own) for own in (steps, [without_speed(step) for step in steps])
    )
    assert told.rounding.speed_mps is not None
    assert derived.rounding.speed_mps is None
    assert tolerances_of(derived).stated_mps is None


def without_speed(text):
    return re.sub(' speed="[^"]*"', "", text)


def test_who_stands_keeps_its_heading(tmp_path):
    """SUMO turns, and slides, who has to stop while it changes lanes; no vehicle does."""
    rows = [(90, 5), (100, 5), (130, 0), (150, 0), (95, 3)]
    one = only(
        read(tmp_path, *(moment(k, body(angle=a, speed=v)) for k, (a, v) in enumerate(rows)))
    )
    turned = [np.degrees(one.states[k].heading) for k in range(5)]
    assert turned == pytest.approx([0, -10, -10, -10, -5])


def test_who_comes_into_sight_while_it_stands_has_the_heading_stated(tmp_path):
    there = [moment(0, body(angle=90)), moment(1), moment(2, body(angle=150, speed=0))]
    one, again = read(tmp_path, *there).participants
    assert [one.id, again.id] == ["f.0", "f.0_2"]
    assert np.degrees(again.states[2].heading) == pytest.approx(-60)


def test_who_walks_turns_where_it_stands(tmp_path):
    walker = {"element": "person", "kind": "DEFAULT_PEDTYPE", "speed": 0}
    one = only(read(tmp_path, *(moment(k, body(angle=90 + 45 * k, **walker)) for k in range(2))))
    assert np.degrees(one.states[1].heading) == pytest.approx(-45)


def test_who_is_articulated_lies_along_its_way(tmp_path):
    """A lorry and its trailer, 16.5 m long, drive 40 m to the east, and 10 m to the north.

    SUMO's angle is that of the first part. The rear is 6.5 m before the corner, the middle, 8.25 m
    back on the way, 1.75 m behind it.
    """
    way = [(2 * k, 0, 90) for k in range(21)] + [(40, 2 * k, 0) for k in range(1, 6)]

    def last(kind):
        rows = [body(x=x, y=y, angle=a, kind=kind) for x, y, a in way]
        one = only(read(tmp_path, *(moment(k, row) for k, row in enumerate(rows))))
        return one.states[0], one.states[25]

    first, state = last("trailer")
    assert (first.x, first.y, first.heading) == pytest.approx((-8.25, 0, 0))
    assert (state.x, state.y) == pytest.approx((40, 1.75))
    assert state.heading == pytest.approx(np.arctan2(10, 6.5))
    # In one part its angle is that of the whole
    _, rigid = last("truck")
    assert (rigid.x, rigid.y) == pytest.approx((40, 10 - 7.1 / 2))


@pytest.mark.parametrize(
    ("words", "articulated"),
    [
        ('vClass="trailer"', True),
        ('vClass="trailer" guiShape="truck"', False),
        ('vClass="bus"', False),
        ('vClass="bus" guiShape="bus/flexible"', True),
        ('vClass="truck" guiShape="truck/trailer"', True),
        ('vClass="tram"', True),
        ('vClass="tram" guiShape="rail/railcar"', True),
    ],
)
def test_who_is_articulated_by_its_shape_or_class(tmp_path, words, articulated):
    file = tmp_path / "types.rou.xml"
    file.write_text(f'<routes><vType id="t" {words}/></routes>', encoding="utf-8")
    assert read_vehicle_types([file])["t"].articulated == articulated


def test_who_jumps_to_another_lane_does_so_with_all_parts(tmp_path):
    rows = [body(x=3 * k, y=-4.8 if k < 5 else -1.6, kind="trailer") for k in range(8)]
    one = only(read(tmp_path, *(moment(k / 10, row) for k, row in enumerate(rows))))
    assert [state.heading for state in one.states.values()] == pytest.approx([0.0] * 8)
    assert [one.states[k].y for k in (4, 5)] == pytest.approx([-4.8, -1.6])


def test_who_turns_round_in_parts_does_so_along_its_way(tmp_path):
    """On a half circle with a radius of 3 m at 1.5 m/s, its first part 100 degrees behind."""
    way = [(-1.5 + 0.15 * k, 0.0, 90.0) for k in range(10)]
    for k in range(64):
        turned = 0.05 * k
        angle = 90 - np.degrees(max(turned - 1.75, 0.0))
        way.append((3 * np.sin(turned), 3 - 3 * np.cos(turned), angle))
    way += [(-0.15 * k, 6.0, -10.0) for k in range(1, 110)]
    rows = [body(x=x, y=y, angle=a, speed=1.5, kind="trailer") for x, y, a in way]
    one = only(read(tmp_path, *(moment(k / 10, row) for k, row in enumerate(rows))))
    state = one.states[len(way) - 1]
    assert (state.x, state.y) == pytest.approx((-16.35 + 8.25, 6), abs=0.01)
    assert abs(state.heading) == pytest.approx(np.pi, abs=0.01)
    # The middle goes all of its way: nowhere farther than the front does
    x, y = np.array([(state.x, state.y) for state in one.states.values()]).T
    assert np.hypot(np.diff(x), np.diff(y)).max() < 0.16


def test_noise_does_not_turn_a_standing_tram(tmp_path):
    """Its front is off by up to 0.2 m each time, for 20 s: no way is driven, and it stays put.

    Over its 22 m, twice that is an angle of 0.4 / 22 = 0.018. The steps of the noise alone would
    add up to a way of more than the tram's length, and the whole body would lie within it.
    """
    pick = random.Random(7)
    rows = [body(x=2 * k, y=0, speed=20, kind="tram") for k in range(20)]
    for _ in range(200):
        x, y = 40 + pick.uniform(-0.2, 0.2), pick.uniform(-0.2, 0.2)
        rows.append(body(x=x, y=y, speed=0, kind="tram"))
    one = only(read(tmp_path, *(moment(k / 10, row) for k, row in enumerate(rows))))
    states = list(one.states.values())[20:]
    assert max(abs(state.heading) for state in states) < 0.02
    assert max(np.hypot(state.x - (40 - 11), state.y) for state in states) < 0.6


def test_time_begins_with_the_simulation(tmp_path):
    recording = read(tmp_path, moment(3600, body()), moment(3600.5, body()))
    assert recording.step_s == 0.5
    assert list(only(recording).states) == [7200, 7201]


def test_time_may_begin_between_two_multiples_of_the_step(tmp_path):
    """As with --begin 0.5."""
    recording = read(tmp_path, *(moment(k + 0.5, body(x=50 + 10 * k)) for k in (0, 1, 3, 4)))
    assert recording.step_s == 1.0
    assert [list(one.states) for one in recording.participants] == [[0, 1], [3, 4]]
    assert any("times count from 0.5 s" in remark for remark in recording.remarks)


@pytest.mark.parametrize(("time", "step_s", "step"), [(0, 1.0, 0), (5, 1.0, 5), (0.3, 0.1, 3)])
def test_one_moment_only(tmp_path, time, step_s, step):
    recording = read(tmp_path, moment(time, body()))
    assert (recording.step_s, list(only(recording).states)) == (step_s, [step])


def test_moments_without_anybody_may_be_left_out(tmp_path):
    other = body(name="other")
    recording = read(tmp_path, moment(0, body()), moment(0.1, body()), moment(5, other))
    assert {one.id: list(one.states) for one in recording.participants} == {
        "f.0": [0, 1],
        "other": [50],
    }


def test_who_vanishes_and_comes_back_is_another_one(tmp_path):
    """SUMO takes vehicles that are stuck out, and puts them back elsewhere."""
    steps = [moment(0, body()), moment(1, body()), moment(2), moment(3, body(x=90))]
    recording = read(tmp_path, *steps)
    assert {one.id: list(one.outlines) for one in recording.participants} == {
        "f.0": [0, 1],
        "f.0_2": [3],
    }


def test_who_is_in_no_place_is_not_there(tmp_path):
    """SUMO writes -2^30 for both x and y then."""
    nowhere = body(x="-1073741824.00", y="-1073741824.00")
    recording = read(tmp_path, moment(0, body()), moment(1, nowhere), moment(2, body()))
    assert [list(one.states) for one in recording.participants] == [[0], [2]]


def test_passengers_are_a_part_of_their_vehicle(tmp_path):
    """Whether they are written inside it or name it; who gets out walks."""
    inside = body(name="p", element="person", x=99)
    car = body().replace("/>", f">{inside}</vehicle>")
    named = body(name="q", element="person", vehicle="f.0")
    recording = read(tmp_path, moment(0, car, named), moment(1, body(), inside))
    assert {one.id: list(one.states) for one in recording.participants} == {"f.0": [0, 1], "p": [1]}


def test_a_person_may_be_called_like_a_vehicle(tmp_path):
    walker = body(element="person", kind="DEFAULT_PEDTYPE", y=-7.4)
    recording = read(tmp_path, moment(0, body(), walker), moment(1, body(), walker))
    assert [(one.id, one.type, len(one.states)) for one in recording.participants] == [
        ("f.0", "car", 2),
        ("person f.0", "pedestrian", 2),
    ]


@pytest.mark.parametrize(
    ("signals", "lit"),
    [
        (0, set()),
        (1, {"right_indicator"}),
        (2 + 8, {"left_indicator", "brake_light"}),
        (4, {"hazard_lights"}),
        (16 + 2048, {"blue_light"}),
        (512, {"doors", "left_doors"}),
        (1024, {"doors", "right_doors"}),
        (512 + 1024, {"doors", "left_doors", "right_doors"}),
    ],
)
def test_lamps(tmp_path, signals, lit):
    one = only(read(tmp_path, moment(0, body(signals=signals)), moment(1, body())))
    assert one.lamps == {0: lit}


def test_states_and_outlines_are_mappings(tmp_path):
    one = only(read(tmp_path, moment(0, body()), moment(1, body(x=30))))
    for mapping in (one.states, one.outlines):
        assert (list(mapping), len(mapping), 2 in mapping, 1 in mapping) == ([0, 1], 2, False, True)
        with pytest.raises(KeyError):
            mapping[2]


@given(
    st.floats(-100, 100),
    st.floats(-100, 100),
    st.floats(-pi, pi),
    st.floats(1, 20),
    st.floats(1, 3),
)
def test_rectangles_are_rectangles(x, y, heading, length, width):
    (corners,) = rectangles(np.array([[x, y]]), np.array([heading]), length, width)
    assert corners.mean(axis=0) == pytest.approx((x, y), abs=1e-9)
    ahead = np.array([np.cos(heading), np.sin(heading)])
    along = (corners - (x, y)) @ ahead
    across = (corners - (x, y)) @ np.array([-ahead[1], ahead[0]])
    assert along.max() == pytest.approx(length / 2)
    assert along.min() == pytest.approx(-length / 2)
    assert across.max() == pytest.approx(width / 2)
    assert across.min() == pytest.approx(-width / 2)
    assert len({(round(a), round(b)) for a, b in zip(along, across, strict=True)}) <= 8


@pytest.mark.parametrize(
    ("option", "whole"),
    [
        ("fcd-output.attributes", True),
        ("device.fcd.period", True),
        ("fcd-output.filter-edges.input-file", False),
        ("fcd-output.filter-shapes", False),
        ("device.fcd.probability", False),
        ("device.fcd.radius", False),
        ("person-device.fcd.explicit", False),
    ],
)
def test_who_is_not_in_data_of_a_part_of_the_traffic_may_be_there(tmp_path, option, whole):
    fcd = data(moment(0, body()), head=f'<{option} value="1"/>')
    found = read_recording(written(tmp_path, fcd))
    assert ("arrivals" in found.complete) == whole
    # What the net has is told all the same
    assert "light" in found.complete
    assert any(f"--{option}:" in remark for remark in found.remarks) != whole


def test_where_a_net_has_no_junction_lanes_that_become_one_are_none(tmp_path):
    """Its nodes say where roads meet: nobody looks for junctions where lanes lie on each other."""
    one, two = (
        f'<edge id=":x_{n}" function="internal"><lane id=":x_{n}_0" index="0" speed="30"'
        f' shape="200,{y} 204,-4.80"/></edge>'
        for n, y in enumerate((-4.8, -1.6))
    )
    road = "".join(
        f'<edge id="{name}" from="{start}" to="{end}">'
        + "".join(
            f'<lane id="{name}_{n}" index="{n}" speed="30" shape="{x0},{y} {x1},{y}"/>'
            for n, y in enumerate(ys)
        )
        + "</edge>"
        for name, start, end, x0, x1, ys in (
            ("in", "a", "x", 0, 200, (-4.8, -1.6)),
            ("out", "x", "b", 204, 400, (-4.8,)),
        )
    )
    links = "".join(
        f'<connection from="in" to="out" fromLane="{n}" toLane="0" via=":x_{n}_0" state="Z"/>'
        f'<connection from=":x_{n}" to="out" fromLane="0" toLane="0" state="M"/>'
        for n in range(2)
    )
    found = read_recording(
        written(tmp_path, data(moment(0, body())), net=f"<net>{one}{two}{road}{links}</net>")
    )
    assert junction_lanelets(found) == frozenset()


@pytest.mark.parametrize(
    ("name", "kind", "known"),
    [
        ("bike@f.0", "bicycle", True),
        ("own@f.0", "bus", True),
        ("own@7", "truck", True),
        # Unknown as it is, and without its copy
        ("cargo@f.0", "car", False),
    ],
)
def test_the_type_of_one_vehicle_alone_is_that_of_which_it_is_a_copy(name, kind, known):
    types = {
        "bike": CLASSES["bicycle"],
        "own": CLASSES["bus"],
        # One may be called so
        "own@7": CLASSES["truck"],
    }
    found, told = vehicle_type(name, "vehicle", types)
    assert (found.kind, told) == (kind, known)
