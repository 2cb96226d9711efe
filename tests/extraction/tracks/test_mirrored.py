"""A mirrored recording, field by field."""

from dataclasses import replace

import numpy as np

from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.recordings import recording, straight, vehicle


def test_lanelets_change_sides():
    lane = straight(1, 0, 100, y=10, left_of=2, left_mark="solid", right_mark="broken")
    mirror = mirrored_recording(recording([lane])).lanelets["1"]
    # The left bound, at y = 12, is the right one at y = -12
    assert mirror.right.tolist() == [[0, -12], [100, -12]]
    assert mirror.left.tolist() == [[0, -8], [100, -8]]
    assert mirror.centre.tolist() == [[0, -10], [100, -10]]
    assert (mirror.left_of, mirror.right_of) == (None, "2")
    assert (mirror.left_mark, mirror.right_mark) == ("broken", "solid")


def test_participants_turn_and_blink_the_other_way():
    body = vehicle(7, {0: (5, 3)}, heading=0.5, speed=4)
    body = replace(body, lamps={0: frozenset({"left_indicator", "brake_light"})})
    (mirror,) = mirrored_recording(recording([], [body])).participants
    state = mirror.states[0]
    assert (state.x, state.y, state.heading, state.speed) == (5, -3, -0.5, 4)
    assert mirror.lamps == {0: {"right_indicator", "brake_light"}}
    assert np.array_equal(mirror.outlines[0], body.outlines[0] * (1, -1))


def test_problems_and_the_side_are_mirrored():
    found = recording([], ego=(1.0, 2.0), heading=0.3, goals=[(9.0, 5.0)])
    mirror = mirrored_recording(replace(found, side="left"))
    (problem,) = mirror.problems
    assert (problem.start.x, problem.start.y, problem.start.heading) == (1, -2, -0.3)
    assert problem.goals.tolist() == [[9, -5]]
    assert mirror.side == "right"
    assert mirrored_recording(found).side is None
