"""Files of data sets, written as their documentation says: frames, axes, units, types, places."""

from math import pi

import numpy as np
import pytest

from rulec import RulecError, read_recording
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.recordings.recording_files import is_recording, read_recordings
from rulec.recordings.recording_format import RecordingSource
from support.builders import osi_traces as osi
from support.builders.sumo_files import ROAD_NET
from support.builders.track_tables import (
    INTERACTION_HEAD,
    NGSIM_HEAD,
    WALKERS_HEAD,
    highd,
    ind,
    interaction_cases,
    interaction_row,
    ngsim_row,
    omega_prime,
    table,
)
from support.defined_words import LEFT_TO_DEFINITIONS

FOOT = 0.3048


def test_highd_has_its_own_roads(tmp_path):
    """Marks at 8.51, 12.59, 16.43 are those of the upper carriageway, which leads to the left.

    In a frame whose y points up its right lane lies between -8.51 and -12.59, north of the left.
    """
    file = highd(tmp_path, [(2, 0.0, 26.0, 30.0, 26), (1, 400.0, 9.5, 36.0, 26)], limit=33.33)
    recording = read_recording(file)
    lanes = recording.lanelets
    assert set(lanes) == {"upper_1", "upper_2", "lower_1", "lower_2"}
    upper, lower = lanes["upper_1"], lanes["lower_1"]
    assert (upper.centre[0, 0] > upper.centre[-1, 0], lower.centre[0, 0] < lower.centre[-1, 0]) == (
        True,
        True,
    )
    assert upper.right[:, 1] == pytest.approx(-8.51)
    assert upper.left[:, 1] == pytest.approx(-12.59)
    assert lower.right[:, 1] == pytest.approx(-28.8)
    assert lower.left[:, 1] == pytest.approx(-24.96)
    assert (upper.left_of, lanes["upper_2"].right_of, upper.right_of) == (
        "upper_2",
        "upper_1",
        None,
    )
    assert (upper.right_mark, upper.left_mark, lanes["upper_2"].left_mark) == (
        "solid",
        "broken",
        "solid",
    )
    assert {lane.limit_mps for lane in lanes.values()} == {120 / 3.6}
    assert {lane.types for lane in lanes.values()} == {frozenset({"highway"})}
    assert (recording.side, recording.country, recording.step_s) == ("right", "DEU", 0.04)


def test_highd_names_the_upper_left_corner(tmp_path):
    """A box of 4.85 x 2.02 m at (0, 26): its middle is 2.425 to the right and 1.01 below."""
    file = highd(tmp_path, [(2, 0.0, 26.0, 30.0, 26), (1, 400.0, 9.5, 36.0, 26)])
    right, left = read_recording(file).participants
    state = right.states[1]
    assert (state.x, state.y, state.heading, state.speed) == pytest.approx((2.425, -27.01, 0, 30))
    assert np.ptp(right.outlines[1], axis=0) == pytest.approx((4.85, 2.02))
    assert np.cos(left.states[1].heading) == pytest.approx(-1)
    assert left.states[1].speed == pytest.approx(36)
    assert left.type == "car"


def test_highd_without_a_limit(tmp_path):
    recording = read_recording(highd(tmp_path, [(2, 0.0, 26.0, 30.0, 26)], limit=-1))
    assert {lane.limit_mps for lane in recording.lanelets.values()} == {None}


def told(recording):
    drives = selected_drives(recording, RequestedDrives(), "some.csv", "right")
    # Where nobody has doors or rails these are told, too
    return drives.told_words() - {"boarding", "conflict_with_rail", "leaving_stop"}


def test_what_highd_can_tell(tmp_path):
    found = read_recording(highd(tmp_path, [(2, 0.0, 26.0, 30.0, 26)], limit=33.33))
    assert told(found) | LEFT_TO_DEFINITIONS == TELLABLE_WORDS["highd"]


def test_what_others_can_tell(tmp_path):
    """Words of lamps are told by tables with columns for them only."""
    net = tmp_path / "road.net.xml"
    net.write_text(ROAD_NET)
    rows = [f"a,{k / 10},{20 + k},-4.8" for k in range(9)]
    file = tmp_path / "cars.csv"
    file.write_text(table("track,t,x,y", *rows))
    without = told(read_recording(file, net))
    lamps = "left_indicator,right_indicator,hazard_lights,blue_light"
    file.write_text(table(f"track,t,x,y,{lamps}", *[f"{row},0,0,0,0" for row in rows]))
    found = {"hazard_lights", "indicator", "warning_lights"}
    assert told(read_recording(file, net)) - without == found
    assert without <= TELLABLE_WORDS["levelx"]
    assert without | found <= TELLABLE_WORDS["tracks"]


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("01_tracksMeta.csv", "there is no `01_tracksMeta.csv` beside it"),
        ("01_recordingMeta.csv", "there is no `01_recordingMeta.csv` beside it"),
    ],
)
def test_a_part_is_missing(tmp_path, file, said):
    tracks = highd(tmp_path, [(2, 0.0, 26.0, 30.0, 5)])
    (tmp_path / file).unlink()
    with pytest.raises(RulecError, match=said):
        read_recording(tracks)


def test_another_part_is_given(tmp_path):
    highd(tmp_path, [(2, 0.0, 26.0, 30.0, 5)])
    for file in ("01_tracksMeta.csv", "01_recordingMeta.csv"):
        with pytest.raises(RulecError) as refused:
            read_recording(tmp_path / file)
        assert "`NN_tracks.csv`" in refused.value.diagnostics[0].help


LANES = table("lane,x,y", "e,0,0", "e,100,0")


def test_ind(tmp_path):
    """Degrees, a size of nothing for who is on foot, and places as they are."""
    bodies = [
        ("truck_bus", (10.0, 2.5), 0.0, (5, 0), 8.0, 26),
        ("pedestrian", (0.0, 0.0), 90.0, (20, -3), 1.2, 26),
    ]
    file = ind(tmp_path, bodies)
    roads = tmp_path / "roads.csv"
    roads.write_text(LANES)
    recording = read_recording(file, roads)
    truck, walker = recording.participants
    assert (truck.type, walker.type, recording.step_s) == ("truck", "pedestrian", 0.04)
    assert truck.states[25].x == pytest.approx(13.0, abs=1e-3)
    assert (truck.states[0].speed, truck.states[0].acceleration) == pytest.approx((8.0, 0.5))
    assert walker.states[0].heading == pytest.approx(pi / 2)
    assert np.ptp(walker.outlines[0], axis=0) == pytest.approx((0.5, 0.5))
    assert (recording.country, recording.side) == ("DEU", "right")


def test_ind_on_a_map_in_utm(tmp_path):
    file = ind(tmp_path, [("car", (4.5, 1.8), 0.0, (5, 0), 8.0, 26)], origin=(297631.3, 5629917.3))
    roads = tmp_path / "roads.csv"
    roads.write_text(table("lane,x,y", "e,297631.3,5629917.3", "e,297731.3,5629917.3"))
    (car,) = read_recording(file, roads).participants
    assert (car.states[0].x, car.states[0].y) == pytest.approx((297636.3, 5629917.3))


def test_ind_needs_a_map(tmp_path):
    with pytest.raises(RulecError, match="R0614"):
        read_recording(ind(tmp_path, [("car", (4.5, 1.8), 0.0, (5, 0), 8.0, 26)]))


def interaction(folder, rows, head=INTERACTION_HEAD, name="vehicle_tracks_007.csv"):
    (folder / "roads.csv").write_text(LANES)
    file = folder / name
    file.write_text(table(head, *rows))
    return file


def test_interaction_with_those_on_foot(tmp_path):
    """A car, somebody at 1.3 m/s and somebody at 5 m/s, who is not on foot."""
    file = interaction(tmp_path, [interaction_row(k) for k in range(1, 12)])
    rows = [f"P1,{k},{100 * k},pedestrian/bicycle,30,{k * 0.13},0,1.3" for k in range(1, 12)]
    rows += [f"P2,{k},{100 * k},pedestrian/bicycle,{20 + k / 2},2,5,0" for k in range(1, 12)]
    interaction(tmp_path, rows, WALKERS_HEAD, "pedestrian_tracks_007.csv")
    recording = read_recording(file, tmp_path / "roads.csv")
    kinds = {one.id: one.type for one in recording.participants}
    assert kinds == {"1": "car", "P1": "pedestrian", "P2": "bicycle"}
    car, walker, _ = recording.participants
    assert (recording.step_s, min(car.states), car.states[1].x) == (0.1, 1, 11.0)
    assert walker.states[5].heading == pytest.approx(pi / 2)
    assert "2.5 m/s in the mean" in " ".join(recording.remarks)


def test_interaction_by_cases(tmp_path):
    (tmp_path / "roads.csv").write_text(LANES)
    file = tmp_path / "DR_USA_Roundabout_FT_train.csv"
    file.write_text(interaction_cases())
    found = list(read_recordings(RecordingSource(file, tmp_path / "roads.csv")))
    assert [one.name for one in found] == ["DR_USA_Roundabout_FT_1", "DR_USA_Roundabout_FT_2"]
    assert [one.participants[0].states[1].x for one in found] == [11.0, 21.0]
    assert {one.side for one in found} == {"right"}


def test_speeds_get_the_sign_of_the_motion(tmp_path):
    """It drives towards -x, its ``vx`` is 10 all the same."""
    rows = [f"2,{k},{100 * k},car,{90 - k},0,10,0,3.1416,4,1.8" for k in range(1, 9)]
    file = interaction(tmp_path, rows)
    (car,) = read_recording(file, tmp_path / "roads.csv").participants
    assert car.states[4].speed == pytest.approx(10, abs=1e-3)


ALONG_Y = table("lane,x,y", "1,1.83,0", "1,1.83,300")


@pytest.mark.parametrize("headless", [True, False])
def test_ngsim(tmp_path, headless):
    """A car of 14.3 feet, whose front is 100 feet along the road: it drives 40 feet a second."""
    (tmp_path / "lanes.csv").write_text(ALONG_Y)
    rows = [ngsim_row(k) for k in range(11)]
    if headless:
        file = tmp_path / "trajectories-0750am-0805am.txt"
        file.write_text("\n".join(row.replace(",", "  ") for row in rows) + "\n")
    else:
        file = tmp_path / "us101.csv"
        file.write_text(table(NGSIM_HEAD, *rows))
    assert is_recording(str(file))
    recording = read_recording(file)
    (car,) = recording.participants
    state = car.states[0]
    assert (state.x, state.y) == pytest.approx((6 * FOOT, (100 - 14.3 / 2) * FOOT))
    assert (state.heading, state.speed) == pytest.approx((pi / 2, 40 * FOOT))
    assert np.ptp(car.outlines[0], axis=0) == pytest.approx((6.4 * FOOT, 14.3 * FOOT))
    assert (recording.step_s, recording.country, recording.side) == (0.1, "USA", "right")


def test_ngsim_by_places(tmp_path):
    (tmp_path / "lanes.csv").write_text(ALONG_Y)
    file = tmp_path / "all.csv"
    rows = [f"{ngsim_row(k)},{place}" for place in ("us-101", "i-80") for k in range(3)]
    file.write_text(table(f"{NGSIM_HEAD},Location", *rows))
    assert {one.name for one in read_recordings(RecordingSource(file))} == {"us-101", "i-80"}


def test_omega_prime(tmp_path):
    file = tmp_path / "objects.csv"
    file.write_text(omega_prime())
    (tmp_path / "road.net.xml").write_text(ROAD_NET)
    (tmp_path / "lanes.csv").write_text(LANES)
    recording = read_recording(file)
    assert [one.type for one in recording.participants] == ["bus", "pedestrian"]
    assert recording.step_s == 0.033
    assert recording.participants[0].states[3].acceleration == 1.0
    assert recording.participants[1].states[3].heading == pytest.approx(1.5)


OSI_NUMBERS = [(role, subtype) for role in (-1, 2, 3, 4, 5) for subtype in (*range(24), 99)]


def omega_prime_of(*numbers):
    """Vehicles one behind the other, by their roles and subtypes."""
    head = omega_prime().partition("\n")[0]
    rows = [
        f"{k * 33000000},{at},{10 * at + k / 3},0,0,10,0,0,0,0,0,4,2,1,0,0,0,2,{role},{subtype}"
        for at, (role, subtype) in enumerate(numbers)
        for k in range(3)
    ]
    return table(head, *rows)


def test_omega_prime_has_the_types_of_a_trace_with_the_same_numbers(tmp_path):
    """A trace leaves out what is -1 in a table."""
    (tmp_path / "objects.csv").write_text(omega_prime_of(*OSI_NUMBERS))
    (tmp_path / "lanes.csv").write_text(table("lane,x,y", "a,0,0", "a,2000,0"))
    messages = []
    for k in range(3):
        bodies = [
            osi.vehicle(at, 10 * at + k / 3, 0, vehicle=kind, **{"role": role} if role >= 0 else {})
            for at, (role, kind) in enumerate(OSI_NUMBERS)
        ]
        road = osi.lane(1, [(0, 0), (2000, 0)]) if k == 0 else b""
        messages.append(osi.ground_truth(k * 33_000_000, *bodies, road, host=0))
    (tmp_path / "same.osi").write_bytes(osi.trace(messages))
    trace, objects = (read_recording(tmp_path / name) for name in ("same.osi", "objects.csv"))
    types = {one.id: one.type for one in trace.participants}
    assert len(types) == len(OSI_NUMBERS)
    assert {one.id: one.type for one in objects.participants} == types


def test_types_of_omega_prime(tmp_path):
    """A trailer of the police's is nobody on call, nor is a policeman on a bicycle."""
    numbers = [(2, 18), (5, 9), (5, 11), (5, 4), (5, 7), (-1, -1), (5, "")]
    (tmp_path / "objects.csv").write_text(omega_prime_of(*numbers))
    (tmp_path / "lanes.csv").write_text(LANES)
    types = [one.type for one in read_recording(tmp_path / "objects.csv").participants]
    assert types == ["bicycle", "unknown", "bicycle", *["priorityVehicle"] * 2, *["unknown"] * 2]


def test_any_map_will_do(tmp_path):
    """A net of SUMO's instead of lanes as a table."""
    net = tmp_path / "road.net.xml"
    net.write_text(ROAD_NET)
    file = tmp_path / "cars.csv"
    file.write_text(table("track,t,x,y", *[f"a,{k / 10},{20 + k},-4.8" for k in range(9)]))
    recording = read_recording(file, net)
    assert len(recording.lanelets) > 1
    assert "STOP" in recording.complete
