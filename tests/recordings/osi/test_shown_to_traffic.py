"""What traffic is shown in traces: lights, signs, lines, crossings, weather; and verdicts on it."""

import numpy as np
import pytest

from rulec import read_recording, verify_recording
from rulec.api.rulebook_compilation import machines
from rulec.recordings.recording import Weather
from support.builders import osi_traces as osi
from support.builders.drive_verdicts import violated
from support.builders.wire_bytes import counted, double, whole

STEP = 100_000_000
RED, YELLOW, GREEN = 2, 3, 4
OFF, CONSTANT, FLASHING = 2, 3, 4
GERMAN = machines("de")

ROAD = b"".join(
    (
        osi.lane(1, [(0, 0), (100, 0)], left_line=[11], right_line=[12]),
        osi.boundary(11, [(0, 2), (100, 2)]),
        osi.boundary(12, [(0, -2), (100, -2)]),
        osi.lane(60, kind=4, forward=None, pairs=[(1, 2), (1, 3), (4, 5)]),
        osi.lane(2, [(120, 0), (200, 0)]),
        osi.lane(3, [(110, 20), (110, 90)]),
        osi.lane(4, [(110, -60), (110, -10)]),
        osi.lane(5, [(112, 20), (112, 90)]),
    )
)


def bulbs(lit, lanes=(1,), first=100, **more):
    """The three bulbs of a head, of which some are lit."""
    return b"".join(
        osi.light(first + colour, colour, CONSTANT if colour in lit else OFF, lanes, **more)
        for colour in (RED, YELLOW, GREEN)
    )


@pytest.fixture
def read(tmp_path):
    def reading(*moments, static=ROAD, speed=10.0):
        file = tmp_path / "some.osi"
        messages = [
            osi.ground_truth(
                k * STEP,
                osi.vehicle(7, 70 + speed * k / 10, 0, speed=speed),
                shown,
                static if k == 0 else b"",
            )
            for k, shown in enumerate(moments)
        ]
        file.write_bytes(osi.trace(messages))
        return read_recording(file)

    return reading


def shown_by(lanelet):
    (light,) = lanelet.lights
    return dict(light.colours)


def test_bulbs_are_a_head(read):
    states = [(RED,), (RED, YELLOW), (GREEN,), (YELLOW,), (), (RED, GREEN)]
    found = read(*map(bulbs, states)).lanelets["1"]
    # Off is dark, and red with green is a fault of which nothing is known
    assert shown_by(found) == {0: "red", 1: "redYellow", 2: "green", 3: "yellow", 4: "inactive"}
    assert found.lights_to == {}


def test_a_light_of_one_colour_after_the_other(read):
    states = [(RED, CONSTANT), (GREEN, CONSTANT), (GREEN, FLASHING), (YELLOW, FLASHING), (5, 3)]
    found = read(*[osi.light(9, colour, mode, [1]) for colour, mode in states])
    assert shown_by(found.lanelets["1"]) == {0: "red", 1: "green", 2: "green", 3: "inactive"}


def test_where_a_light_is_missing_nothing_is_known(read):
    found = read(bulbs([RED]), b"", bulbs([GREEN])).lanelets["1"]
    assert shown_by(found) == {0: "red", 2: "green"}


def test_an_arrow_is_for_the_way_that_it_points_to(read):
    left = {"icon": 4, "first": 200, "place": (5.0, 0.0)}
    straight = {"icon": 3, "place": (0.0, 0.0)}
    moments = [bulbs([RED], **left) + bulbs([GREEN], **straight)] * 2
    found = read(*moments).lanelets["1"]
    told = {way: dict(light.colours) for way, light in found.lights_to.items()}
    assert told == {"60_1_2": {0: "green", 1: "green"}, "60_1_3": {0: "red", 1: "red"}}


def test_a_green_arrow_beside_a_red_light(read):
    arrow = osi.light(300, GREEN, CONSTANT, [1], icon=4, place=(5.0, 0.0))
    found = read(bulbs([RED]) + arrow).lanelets["1"]
    assert found.lights_to["60_1_2"].colour_at(0) == "red"
    assert found.lights_to["60_1_3"].colour_at(0) == "green"


def test_lights_of_others_and_of_no_lane(read):
    found = read(bulbs([RED], icon=15) + bulbs([RED], lanes=(), first=200))
    assert found.lanelets["1"].lights == ()
    assert found.remarks[-2] == (
        "traffic lights are assigned to no lane, and left out: 202, 203, 204"
    ) or ("traffic lights are assigned to no lane, and left out: 202, 203, 204" in found.remarks)


def driven(tmp_path, y_at, lit, road=ROAD, count=60):
    """A car at 10 m/s along x from 70 m on, ``y_at`` by moment, and what is lit meanwhile."""
    messages = []
    for k in range(count):
        heading = float(np.arctan2(y_at(k + 1) - y_at(k), 1.0))
        body = osi.vehicle(7, 70.0 + k, y_at(k), heading, None)
        messages.append(osi.ground_truth(k * STEP, body, lit(k), road if k == 0 else b""))
    file = tmp_path / "driven.osi"
    file.write_bytes(osi.trace(messages))
    return violated(read_recording(file), GERMAN)["7"]


def test_a_red_light_that_is_driven_over(tmp_path):
    """Its front is at 72 m; the line across the lane's end, at 100 m, it crosses 2.8 s later."""
    road = ROAD + osi.mark(8, 17, (100, 0), [1])
    found = driven(tmp_path, lambda k: 0.0, lambda k: bulbs([RED]), road)
    assert found["red_light"] == pytest.approx(2.9, abs=0.11)
    assert "red_light" not in driven(tmp_path, lambda k: 0.0, lambda k: bulbs([GREEN]), road)


@pytest.mark.parametrize(("kind", "is_wrong"), [(3, True), (4, False)])
def test_a_solid_line_that_is_driven_over(tmp_path, kind, is_wrong):
    """From the middle of its lane to that of the one beside it, within 3 s."""
    road = b"".join(
        (
            osi.lane(1, [(0, 0), (400, 0)], left_line=[11], right_line=[12], left=[2]),
            osi.lane(2, [(0, 4), (400, 4)], left_line=[13], right_line=[11], right=[1]),
            osi.boundary(11, [(0, 2), (400, 2)], kind),
            osi.boundary(12, [(0, -2), (400, -2)]),
            osi.boundary(13, [(0, 6), (400, 6)]),
        )
    )
    found = driven(tmp_path, lambda k: float(np.clip((k - 20) / 30 * 4, 0, 4)), lambda k: b"", road)
    assert ("solid_line" in found) is is_wrong


def test_signs(read):
    signs = osi.sign(1, 17, [1]) + osi.sign(2, 52, [1], 30) + osi.sign(3, 52, [2], 20, 4)
    # A lane of which nothing is known, below a ban that nothing is, and a unit that is none
    signs += osi.sign(5, 17, [77]) + osi.sign(6, 56, [2], supplements=[2])
    signs += osi.sign(7, 52, [3], 30, 2)
    found = read(b"", static=ROAD + signs).lanelets
    assert found["1"].signs == {"STOP", "MAX_SPEED"}
    assert found["1"].limit_mps == pytest.approx(30 / 3.6)
    assert found["2"].signs == {"MAX_SPEED", "NO_OVERTAKING_START"}
    assert found["2"].limit_mps == pytest.approx(20 * 1609.344 / 3600)
    assert (found["3"].signs, found["3"].limit_mps) == ({"MAX_SPEED"}, None)
    assert [found[k].untold_signs for k in "123"] == [set(), set(), {"MAX_SPEED"}]


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_what_says_for_whom_it_holds_may_hold(read, order):
    """Below a limit of 10 it says for whom, and beside it stands one for all; so below a stop."""
    limits = osi.sign(1, 52, [1], 30), osi.sign(2, 52, [1], 10, supplements=[15])
    signs = limits[order[0]] + limits[order[1]] + osi.sign(3, 17, [2], supplements=[15])
    found = read(b"", static=ROAD + signs).lanelets
    assert found["1"].limit_mps is None
    assert found["1"].signs == {"MAX_SPEED"}
    assert found["2"].signs == set()
    assert [found[k].untold_signs for k in "12"] == [{"MAX_SPEED"}, {"STOP"}]


def test_what_signs_show_that_change_is_unknown(read):
    found = read(osi.sign(1, 52, [1], 80), osi.sign(1, 52, [1], 60))
    assert found.lanelets["1"].limit_mps is None
    assert found.lanelets["1"].untold_signs == {"MAX_SPEED"}
    assert "what signs show that change is unknown: 1" in found.remarks


@pytest.mark.parametrize(
    ("more", "is_judged"),
    [({}, True), ({"supplements": [15]}, False), ({"unit": 2}, False)],
    ids=["for all", "for some", "in no unit"],
)
def test_a_limit_that_may_hold_is_no_reason_for_a_verdict(tmp_path, more, is_judged):
    """At 36 km/h, where 30 hold, or might."""
    road = ROAD + osi.sign(1, 52, [1, 2, 3], 30, **more)
    cars = [osi.vehicle(7, 10.0 + k, 0.0, 0.0, None) for k in range(20)]
    messages = [osi.ground_truth(k * STEP, car, road) for k, car in enumerate(cars)]
    file = tmp_path / "driven.osi"
    file.write_bytes(osi.trace(messages))
    (judged,) = verify_recording(read_recording(file), "de").answers()
    assert ("speed_limit" in {x.rule for x in judged.answer.violations}) is is_judged
    assert ("speed_limit" in {x.rule for x in judged.answer.not_judged}) is not is_judged


def test_a_stop_line_lies_across_its_lanes(read):
    found = read(b"", static=ROAD + osi.mark(8, 17, (95, 0.3), [1])).lanelets
    np.testing.assert_allclose(found["1"].stop_line, [(95, 2), (95, -2)])
    assert found["2"].stop_line is None


@pytest.mark.parametrize("yaw", [0.0, np.pi])
def test_a_crossing_leads_across_its_lane(read, yaw):
    # 3 m along the road, and 8 m across it
    painted = osi.mark(8, 87, (50, 0), [1], size=(0.01, 8.0, 3.0), yaw=yaw)
    crossing = read(b"", static=ROAD + painted).lanelets["crossing_8"]
    assert crossing.types == {"crosswalk"}
    np.testing.assert_allclose(np.abs(crossing.centre - (50, 0)), [(0, 4), (0, 4)], atol=1e-9)
    np.testing.assert_allclose(np.abs(crossing.left - crossing.right), [(3, 0)] * 2, atol=1e-9)


@pytest.mark.parametrize(
    ("rain", "fog", "water", "weather"),
    [
        (5, 2, None, Weather(wet=True, visibility_m=1000.0, raining=True)),
        (2, 9, None, Weather(raining=False)),
        (1, 9, None, Weather()),
        (3, 6, 0.0, Weather(wet=False, visibility_m=1000.0, raining=True)),
        (2, 0, 0.4, Weather(wet=True, raining=False)),
    ],
)
def test_weather(read, rain, fog, water, weather):
    conditions = b"" if water is None else counted(11, double(2, water))
    lane = counted(
        10, osi.identifier(1, 50), counted(2, osi.line(3, [(0, 50), (9, 50)]), conditions)
    )
    said = counted(12, whole(6, rain), whole(7, fog))
    assert read(said, static=ROAD + lane).weather == weather


@pytest.mark.parametrize(
    ("level", "night"),
    [(2, True), (5, True), (6, None), (8, None), (9, False), (10, False), (0, None)],
)
def test_it_is_night_below_ten_lux_and_not_from_a_thousand_on(read, level, night):
    assert read(counted(12, whole(1, level)), static=ROAD).weather.night is night
