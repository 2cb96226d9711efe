"""Traces as files: messages, their kinds, times, objects, and what is refused."""

import numpy as np
import pytest

from rulec import read_recording
from rulec.diagnostics import RulecError
from support.builders import mcap_files as mcap
from support.builders import osi_traces as osi

STEP = 33_000_000
ROAD = osi.lane(1, [(0, 0), (200, 0)], left_line=[11], right_line=[12])
ROAD += osi.boundary(11, [(0, 2), (200, 2)]) + osi.boundary(12, [(0, -2), (200, -2)])


def moved(count=5, step=STEP, **more):
    """Messages of a car at 10 m/s, the road in the first of them only."""
    return [
        osi.ground_truth(
            k * step,
            osi.vehicle(7, 10 + 10 * k * step / osi.SECOND, 0, **more),
            ROAD if k == 0 else b"",
            host=7,
        )
        for k in range(count)
    ]


def read(tmp_path, data, name="some.osi"):
    file = tmp_path / name
    file.write_bytes(data)
    return read_recording(file)


def refused(tmp_path, data, name="some.osi"):
    with pytest.raises(RulecError) as caught:
        read(tmp_path, data, name)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    return found.message


def test_a_track_and_its_time_step(tmp_path):
    found = read(tmp_path, osi.trace(moved()))
    (car,) = found.participants
    assert (found.name, found.step_s, found.form) == ("some", 0.033, "ASAM OSI trace")
    assert (found.ego, car.id, car.type) == ("7", "7", "car")
    assert list(car.states) == [0, 1, 2, 3, 4]
    state = car.states[2]
    assert (state.x, state.y, state.heading, state.speed) == pytest.approx((10.66, 0, 0, 10))
    # The outline is of 4 m by 2 m around the middle
    assert np.ptp(car.outlines[2], axis=0) == pytest.approx((4, 2))
    assert found.remarks == ()


@pytest.mark.parametrize("method", ["", "lz4", "zstd"])
@pytest.mark.parametrize("kind", ["GroundTruth", "SensorView", "SensorData"])
def test_mcap_of_every_kind_says_the_same(tmp_path, method, kind):
    wrapped = {
        "GroundTruth": lambda x: x,
        "SensorView": lambda x: osi.sensor_view(x, host=7),
        "SensorData": lambda x: osi.sensor_data(osi.sensor_view(x)),
    }
    messages = [wrapped[kind](x) for x in moved()]
    packed = read(tmp_path, mcap.recorded(messages, f"osi3.{kind}", method), "some.mcap")
    plain = read(tmp_path, osi.trace(messages))
    for found in (packed, plain):
        assert (found.step_s, found.ego) == (0.033, "7")
        assert [car.states[4].x for car in found.participants] == pytest.approx([11.32])
        assert list(found.lanelets) == ["1"]


def test_of_several_channels_that_with_ground_truth_counts(tmp_path):
    inner = mcap.schema(1, "osi3.SensorData") + mcap.schema(2, "osi3.GroundTruth")
    inner += mcap.schema(3, "ros.Image") + mcap.channel(1, 1) + mcap.channel(2, 2)
    inner += mcap.channel(3, 3)
    for k, truth in enumerate(moved()):
        inner += mcap.message(1, k, b"") + mcap.message(3, k, b"\xff") + mcap.message(2, k, truth)
    found = read(tmp_path, mcap.file(mcap.chunk(inner)), "some.mcap")
    assert len(found.participants[0].states) == 5


def test_mcap_of_others_says_what_it_holds(tmp_path):
    inner = mcap.schema(3, "ros.Image") + mcap.channel(3, 3) + mcap.message(3, 0, b"\xff")
    said = refused(tmp_path, mcap.file(mcap.chunk(inner)), "some.mcap")
    assert "MCAP without ground truth" in said
    assert "ros.Image" in said


def test_nanoseconds_that_jitter_are_one_step(tmp_path):
    times = [0, STEP + 1, 2 * STEP - 1, 3 * STEP + 1, 5 * STEP]
    messages = [osi.ground_truth(t, osi.vehicle(7, 10, 0), ROAD) for t in times]
    found = read(tmp_path, osi.trace(messages))
    # The fifth message is missing, its step is not
    assert found.step_s == 0.033
    assert list(found.participants[0].states) == [0, 1, 2, 3, 5]
    assert found.remarks == ()


def test_times_that_are_off_by_more_are_said_to_be(tmp_path):
    times = [0, 100_000_000, 206_000_000, 300_000_000, 400_000_000]
    messages = [osi.ground_truth(t, osi.vehicle(7, 10, 0), ROAD) for t in times]
    found = read(tmp_path, osi.trace(messages))
    assert found.step_s == 0.1
    assert "times are up to 6.0 ms off steps of 0.1 s" in found.remarks[0]


def test_uneven_times_are_refused(tmp_path):
    times = [0, 100_000_000, 250_000_000, 300_000_000, 400_000_000]
    messages = [osi.ground_truth(t, osi.vehicle(7, 10, 0), ROAD) for t in times]
    assert "its times are uneven: 0.25 s" in refused(tmp_path, osi.trace(messages))
    turned = [osi.ground_truth(t, osi.vehicle(7, 10, 0), ROAD) for t in (100, 50)]
    assert "before that of the message before" in refused(tmp_path, osi.trace(turned))
    far = [osi.ground_truth(t, osi.vehicle(7, 10, 0), ROAD) for t in (0, 1, 2, 10**18)]
    assert "are spread over" in refused(tmp_path, osi.trace(far))


def test_messages_of_one_moment_count_once(tmp_path):
    messages = [x for x in moved() for _ in range(2)]
    found = read(tmp_path, osi.trace(messages))
    assert len(found.participants[0].states) == 5
    assert found.remarks == ("5 messages have the time of the one before and are left out",)


@pytest.mark.parametrize(
    ("vehicle", "role", "kind"),
    [
        (2, 2, "car"),
        (6, 2, "car"),
        (7, 2, "truck"),
        (10, 2, "motorcycle"),
        (11, 2, "bicycle"),
        (12, 6, "bus"),
        (13, 2, "train"),
        (15, 2, "pedestrian"),
        (4, 5, "priorityVehicle"),
        (7, 4, "priorityVehicle"),
        # A trailer does not drive, and what a later version adds is not known
        (9, 2, "unknown"),
        (99, 2, "unknown"),
    ],
)
def test_kinds_of_vehicles(tmp_path, vehicle, role, kind):
    found = read(tmp_path, osi.trace(moved(vehicle=vehicle, role=role)))
    assert [body.type for body in found.participants] == [kind]


def test_people_and_animals(tmp_path):
    who = osi.vehicle(1, 0, 0, kind=3) + osi.vehicle(2, 5, 0, kind=4)
    found = read(tmp_path, osi.trace([osi.ground_truth(0, who, ROAD)]))
    assert [body.type for body in found.participants] == ["pedestrian", "unknown"]


def test_lamps_are_told_where_all_are(tmp_path):
    # Field 1 are indicators (2 off, 3 left, 5 both), 7 brake lamps (2 off, 3 on)
    shown = [{1: 3, 7: 2}, {1: 3, 7: 3}, {1: 5, 7: 2}, {1: 0, 7: 2}, {}]
    messages = [
        osi.ground_truth(k * STEP, osi.vehicle(7, 10, 0, lamps=lamps), ROAD)
        for k, lamps in enumerate(shown)
    ]
    (car,) = read(tmp_path, osi.trace(messages)).participants
    assert car.shows == {"left_indicator", "right_indicator", "hazard_lights", "brake_light"}
    assert car.lamps == {
        0: {"left_indicator"},
        1: {"left_indicator", "brake_light"},
        2: {"hazard_lights"},
    }


def test_speed_and_direction_from_places_where_nothing_says_them(tmp_path):
    messages = [
        osi.ground_truth(k * 100_000_000, osi.vehicle(7, 10, 2.0 * k, None, None), ROAD)
        for k in range(4)
    ]
    (car,) = read(tmp_path, osi.trace(messages)).participants
    assert [x.speed for x in car.states.values()] == pytest.approx([20.0] * 4)
    assert [x.heading for x in car.states.values()] == pytest.approx([np.pi / 2] * 4)


def test_a_vehicle_that_rolls_back_has_a_negative_speed(tmp_path):
    (car,) = read(tmp_path, osi.trace(moved(speed=-3.0))).participants
    assert car.states[0].speed == -3.0


def test_what_most_messages_say_of_a_body_counts(tmp_path):
    """The first one takes a lorry of 12 m by 2.5 m for a car, and sees half of it."""
    said = [(4, (6.0, 2.4)), (7, (12.2, 2.5)), (7, (12.0, 2.5)), (7, None), (4, (11.8, 2.6))]
    messages = [
        osi.ground_truth(
            k * STEP, osi.vehicle(7, 10 + k, 0.0, vehicle=kind, size=size), ROAD, host=7
        )
        for k, (kind, size) in enumerate(said)
    ]
    (body,) = read(tmp_path, osi.trace(messages)).participants
    assert body.type == "truck"
    # In the middle of 6, 11.8, 12 and 12.2 m
    assert np.ptp(body.outlines[0], axis=0) == pytest.approx([11.9, 2.5])


def test_a_size_that_is_not_said_is_usual(tmp_path):
    found = read(tmp_path, osi.trace(moved(size=None, vehicle=12)))
    assert np.ptp(found.participants[0].outlines[0], axis=0) == pytest.approx((12, 2.5))
    assert found.remarks == ("missing sizes are assumed to be usual: of 7",)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "it is empty"),
        (b"\1\0", "it ends within the size of a message"),
        (b"\xff\xff\xff\xff", "a message has 4,294,967,295 bytes"),
        (b"\x09\0\0\0abc", "3 are left"),
        (osi.trace([b""]), "it contains no road users"),
        (osi.trace([osi.ground_truth(0, ROAD)]), "it contains no road users"),
        (osi.trace([osi.ground_truth(0, osi.vehicle(None, 0, 0))]), "has no `id`"),
        (osi.trace([osi.ground_truth(0, osi.vehicle(1, np.nan, 0))]), "`x` is nan"),
        (osi.trace([osi.ground_truth(0, osi.vehicle(1, 1e9, 0))]), "`x` is 1e+09"),
        (osi.trace([osi.ground_truth(0, b"\x2a\x05ab")]), "a value begins that has more bytes"),
    ],
)
def test_what_is_no_trace(tmp_path, data, said):
    assert said in refused(tmp_path, data)


def test_mistakes_name_their_message(tmp_path):
    messages = [*moved(3), osi.ground_truth(3 * STEP, osi.vehicle(7, np.inf, 0))]
    assert "(its message 4)" in refused(tmp_path, osi.trace(messages))


def test_a_trace_without_lanes_takes_the_map_beside_it(tmp_path):
    data = osi.trace([osi.ground_truth(0, osi.vehicle(1, 50, 0, speed=1.0))])
    with pytest.raises(RulecError, match=r"no map of its name .*\[R0614\]"):
        read(tmp_path, data)
    (tmp_path / "some.net.xml").write_text(
        '<net version="1.20"><edge id="east" from="a" to="b"><lane id="east_0" index="0"'
        ' speed="13.89" length="200" shape="0,0 200,0"/></edge></net>'
    )
    found = read(tmp_path, data)
    assert list(found.lanelets) == ["east_0"]
    assert found.lanelets["east_0"].limit_mps == pytest.approx(50 / 3.6)
