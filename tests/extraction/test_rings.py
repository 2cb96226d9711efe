"""Drives on closed roads: a ring has no end at which it could be cut."""

from itertools import pairwise
from math import cos, pi, sin

import pytest

from rulec.extraction.drives import Drive, Drives
from rulec.recordings.recording import Participant, TrackState
from support.builders.recordings import lanelet, recording, rectangle
from support.measured import middle

RADIUS_M = 60.0
LENGTH_M = 2 * pi * RADIUS_M
PARTS = 6


def on_ring(s):
    """Place and heading at a distance around the ring, counter-clockwise."""
    angle = s / RADIUS_M
    return RADIUS_M * cos(angle), RADIUS_M * sin(angle), angle + pi / 2


def ring():
    part = LENGTH_M / PARTS
    return [
        lanelet(
            k + 1,
            [on_ring(part * (k + j / 12))[:2] for j in range(13)],
            successors=((k + 1) % PARTS + 1,),
            predecessors=((k - 1) % PARTS + 1,),
        )
        for k in range(PARTS)
    ]


def around(number, start, mps, count, step_s=0.5):
    states, outlines = {}, {}
    for k in range(count):
        x, y, heading = on_ring(start + mps * step_s * k)
        states[k] = TrackState(x, y, heading, mps, 0.0)
        outlines[k] = rectangle(x, y, 4, 2, heading)
    return Participant(str(number), "car", False, states, outlines)


def drive(*cars):
    (found,) = Drives(recording(ring(), cars), "right").of("7")
    assert isinstance(found, Drive)
    return found.trace.states


@pytest.mark.parametrize("start", [0, 30, 100, 250, 370])
@pytest.mark.parametrize("count", [4, 20, 100])
def test_the_shorter_way_round_says_who_is_ahead(start, count):
    # One 50 m ahead, one 50 m behind, wherever the ring begins and through more than one lap
    states = drive(
        around(7, start, 10, count),
        around(8, start + 50, 10, count),
        around(9, start - 50, 10, count),
    )
    assert len(states) == count
    for state in states:
        assert state["station"] == {"8": "behind", "9": "in_front_of"}
        assert state["lateral"] == {"8": "same_lane", "9": "same_lane"}
        # Bodies of 4 m on a bend reach a little farther than along a line
        assert middle(state["gap"]) == pytest.approx({"8": 46, "9": 46}, abs=0.5)
        assert state["precedes"] == {"8": True, "9": False}
        assert middle(state["speed"]) == pytest.approx(36, abs=0.5)


def test_who_stands_is_passed_on_every_lap():
    stands = around(8, 100, 0, 1)
    stands = Participant("8", "parkedVehicle", True, stands.states, stands.outlines)
    # Two laps at 20 m/s: 2 x 377 m are 75 states
    states = drive(around(7, 20, 20, 76), stands)
    # When it comes again it is another object
    stations = [next(iter(state.get("station", {}).values()), None) for state in states]
    passed = sum(
        before == "behind" and after in ("beside", "in_front_of")
        for before, after in pairwise(stations)
    )
    assert passed == 2
