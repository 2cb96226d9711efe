"""Ego's state, size and lanelet at time 0."""

from dataclasses import replace
from math import cos, pi, sin

import pytest

from rulec.diagnostics import RulecError
from rulec.scenario.recorded.ego_start import (
    ego_motion,
    ego_size,
    ego_start,
    reference_lanelet,
)
from rulec.scenario.scenario_model import Choice
from support.builders.recordings import recording, straight, vehicle

DRIVER = vehicle(7, {3: (30, 0), 4: (35, 1), 6: (45, 0)}, length=5.0, width=1.8)
LANES = [straight(1, 0, 100), straight(2, 0, 100, y=4)]
FOUND = recording(LANES, [DRIVER, vehicle(8, {0: (60, 4)}, standing=True)], ego=(9.0, 0.5))


def start(found=FOUND, **choice):
    return ego_start(found, Choice(**choice), "file")


def refusal(found=FOUND, **choice):
    with pytest.raises(RulecError) as caught:
        start(found, **choice)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0612"
    return f"{diagnostic.message}; {diagnostic.help}"


def test_a_participant_starts_at_its_first_step_and_goes_to_its_last_place():
    found = start(ego=7)
    assert (found.participant, found.step, found.state.x) == ("7", 3, 30)
    assert found.targets.tolist() == [[45, 0]]


def test_a_participant_starts_at_the_time_chosen():
    # Steps are half a second long
    assert (start(ego="7", at_s=2.0).step, start(ego="7", at_s=2.0).state.y) == (4, 1)
    assert "has no state at 2.5 s; choose a time from 1.5 s to 3 s" in refusal(ego=7, at_s=2.5)
    assert "no states at 1.7 s; choose a multiple of its time step" in refusal(ego=7, at_s=1.7)


def test_the_first_planning_problem_is_the_usual_ego():
    found = start()
    assert (found.participant, found.step, found.state.x) == (None, 0, 9)
    assert start(ego=99).state == found.state
    assert "planning problem 99 defines ego at 0 s" in refusal(ego=99, at_s=1.0)


def test_a_problem_takes_the_part_of_a_participant_in_its_place():
    double = vehicle(5, {0: (9.05, 0.5), 1: (14, 0.5)})
    assert start(replace(FOUND, participants=(double,))).participant == "5"
    beside = vehicle(5, {0: (9.15, 0.5), 1: (14, 0.5)})
    assert start(replace(FOUND, participants=(beside,))).participant is None


def test_what_is_not_there_cannot_be_chosen():
    assert "no moving obstacle 8; choose one of `99`, `7`" in refusal(ego=8)
    nobody = replace(FOUND, problems=())
    assert "choose one of its vehicles with `ego`: `7`" in refusal(nobody)
    assert "the file has no moving participant" in refusal(replace(nobody, participants=()))


def test_the_size_is_the_participants_unless_it_is_chosen():
    own = start(ego=7)
    assert ego_size(FOUND, own, Choice()) == pytest.approx((5.0, 1.8))
    assert ego_size(FOUND, own, Choice(ego_width_m=2.5)) == pytest.approx((5.0, 2.5))
    assert ego_size(FOUND, start(), Choice()) == (0, 0)


def test_the_lanelet_is_the_one_under_ego_or_the_one_chosen():
    own = start(ego=7).state
    assert reference_lanelet(FOUND, Choice(), own, "file") == "1"
    assert reference_lanelet(FOUND, Choice(reference=2), own, "file") == "2"
    for choice, state, message in [
        (Choice(reference=3), own, "there is no lanelet 3"),
        (Choice(), replace(own, y=90.0, heading=pi), "ego is on no lanelet"),
    ]:
        with pytest.raises(RulecError, match=message):
            reference_lanelet(FOUND, choice, state, "file")


def moving(speed, heading):
    own = start(ego=7)
    return replace(own, state=replace(own.state, speed=speed, heading=heading))


@pytest.mark.parametrize(("speed", "heading"), [(1e-7, 1.5), (0.05, 0.8), (-1e-6, 0.1), (-1, 0.3)])
def test_who_hardly_moves_or_backs_slowly_stands(speed, heading):
    found = ego_motion(FOUND, moving(speed, heading), 0.0, "1", "file")
    assert (found["speed"], found["lateral_speed"]) == (0, 0)


@pytest.mark.parametrize(("speed", "heading"), [(0.2, 0.8), (1.0, 1.7), (-1.0, 2.5)])
def test_who_turns_or_backs_into_a_lane_moves_aside(speed, heading):
    found = ego_motion(FOUND, moving(speed, heading), 0.0, "1", "file")
    assert found["speed"] == pytest.approx(max(speed * cos(heading), 0))
    assert found["lateral_speed"] == pytest.approx(speed * sin(heading))


def test_who_goes_back_along_its_lanelet_starts_nowhere():
    # Turning round, or backing out of a place to park
    assert ego_motion(FOUND, moving(1.5, pi), 0.0, "1", "file")["speed"] == 0
    assert ego_motion(FOUND, moving(9.0, pi / 2), 0.0, "1", "file")["speed"] == pytest.approx(0)
    for speed, heading in [(9.0, pi), (-9.0, 0.0)]:
        with pytest.raises(RulecError, match=r"backwards along lanelet 1, at 9\.0 m/s") as caught:
            ego_motion(FOUND, moving(speed, heading), 0.0, "1", "file")
        assert caught.value.diagnostics[0].code == "R0612"
