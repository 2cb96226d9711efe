"""Participants of unknown type that drive as only vehicles can."""

import numpy as np
import pytest

import rulec
from rulec.recordings.mending.mended_recording import mended

STEP_S = 0.1
LANE = rulec.build_lanelet("on", [(0, 0), (600, 0)])


def types(mps, across_m=0.0, degrees=0.0, jump_m=0.0, kind="unknown"):
    t = np.arange(0, 4.05, STEP_S)
    way = mps * t + jump_m * (t > 2.0)
    x, y = 150 + way * np.cos(np.radians(degrees)), across_m + way * np.sin(np.radians(degrees))
    car = rulec.build_participant("1", "car", t, 300 + 10 * t, 0 * t, step_s=STEP_S)
    body = rulec.build_participant("2", kind, t, x, y, step_s=STEP_S)
    found = mended(rulec.build_recording([LANE], [car, body], step_s=STEP_S))
    return found.participants[1].object_types


@pytest.mark.parametrize("degrees", [0.0, 180.0])
def test_who_drives_along_a_lane_faster_than_anybody_rides_is_a_vehicle(degrees):
    assert types(15.0, degrees=degrees) == ("vehicle", "road_user", "obstacle")


@pytest.mark.parametrize(
    "seen",
    [
        {"mps": 12.5},
        {"mps": 20.0, "across_m": 9.0},
        {"mps": 20.0, "degrees": 60.0},
        {"mps": 3.0, "jump_m": 40.0},
    ],
    ids=["ridden", "beside", "across", "jumping"],
)
def test_others_stay_of_unknown_type(seen):
    assert types(**seen) == ("road_user", "obstacle")


def test_other_types_stay():
    assert types(20.0, kind="pedestrian")[0] == "pedestrian"


def test_it_is_followed_as_any_vehicle_is():
    t = np.arange(0, 8.05, STEP_S)
    bodies = [
        rulec.build_participant(name, kind, t, x + 15.0 * t, 0 * t, step_s=STEP_S)
        for name, kind, x in (("a", "car", 50.0), ("l", "unknown", 60.5))
    ]
    recording = rulec.build_recording([LANE], bodies, step_s=STEP_S, side="right")
    (drive, _) = rulec.verify_recording(recording, rulec.compile_rulebook("de"))
    assert "following_distance" in {violation.rule for violation in drive.answer.violations}
