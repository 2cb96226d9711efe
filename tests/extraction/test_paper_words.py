"""Recordings in the paper's words, by its rules."""

import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.drives import Drives
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.drive_verdicts import violated
from support.builders.recordings import lanelet, recording, straight, vehicle

STEP_S = 0.5
PAPER = machines("esterle2019")
CROSSWALK = lanelet(9, [(100.0, -6.0), (100.0, 6.0)], types=frozenset({"crosswalk"}))


def going(number, x, mps, y=0.0, count=12, **more):
    return vehicle(number, {k: (x + mps * STEP_S * k, y) for k in range(count)}, **more)


def walking(number, y, mps, count=12):
    """Across the road at x = 100."""
    places = {k: (100.0, y + mps * STEP_S * k) for k in range(count)}
    return vehicle(number, places, "pedestrian", length=0.5, width=0.5)


def positions(cars, lanes, side="right"):
    (drive,) = Drives(recording([*lanes, CROSSWALK], cars), side).of("7")
    return [state["position"]["8"] for state in drive.trace.states]


TWO_LANES = [straight(1, 0, 300, left_of=2), straight(2, 0, 300, y=4, right_of=1)]


def test_past_a_car_on_the_right():
    # 8 is 4 m long at x = 60, on the left lane; the front of 7 is at 42 + 5 k. Whether 7 had been
    # in its lane before, and passes it, nobody saw.
    cars = [going(7, 40, 10.0), going(8, 60, 0.0, y=4.0)]
    assert positions(cars, TWO_LANES) == [UNKNOWN] + ["r"] * 11
    assert violated(recording(TWO_LANES, cars), PAPER) == {"7": {}, "8": {}}


def test_pulling_out_to_the_right_and_getting_in_front():
    # R1: behind 8 in its lane, then right of it, then in front of it
    path = {0: (40, 4), 1: (45, 2.5), 2: (50, 0), 3: (55, 0), 4: (60, 0), 5: (65, 0)}
    path |= {6: (70, 1.5), 7: (75, 4), 8: (80, 4)}
    cars = [vehicle(7, path), going(8, 60, 0.0, y=4.0, count=9)]
    told = positions(cars, TWO_LANES)
    # The middle is right of the mark, at y = 2, in states 2 to 6
    assert told == ["b"] * 2 + ["r"] * 5 + ["f"] * 2
    assert violated(recording(TWO_LANES, cars), PAPER)["7"] == {"R1": 3.5}


@pytest.mark.parametrize(
    ("x", "y", "told"), [(46, 2.6, "r"), (46, -2.6, "l"), (48.5, 0.0, "b"), (41.5, 0.4, "f")]
)
def test_who_reaches_into_egos_lane_is_at_its_side_or_runs_into_it(x, y, told):
    """Bodies are 4 m long and 2 m wide, ego's middle is at 45 m; the line at 2 m is overrun."""
    lanes = [
        straight(1, 0, 300, y=-4, left_of=2),
        straight(2, 0, 300, left_of=3, right_of=1),
        straight(3, 0, 300, y=4, right_of=2),
    ]
    cars = [going(7, 40, 10.0, y=0.0), going(8, x, 0.0, y=y)]
    assert positions(cars, lanes)[1] == told


@pytest.mark.parametrize(
    ("y", "mps", "before", "beside"),
    [
        (-1.5, 0.3, "l", "f"),  # it walks to the left: ego comes from its left, then is before it
        (-1.5, -0.3, "r", "b"),  # and to the right: ego is behind it
        (1.5, 0.3, "l", "b"),
        (1.5, -0.3, "r", "f"),
    ],
)
def test_who_walks_has_its_own_front(y, mps, before, beside):
    # Its frame takes up the crossing, x = 98 to 102; the front of 7 is at 82 + 5 k. Whether 7 had
    # been behind it before nobody saw.
    cars = [going(7, 80, 10.0, count=5), walking(8, y, mps, count=5)]
    assert positions(cars, [straight(1, 0, 300)]) == [UNKNOWN] + [before] * 3 + [beside]
    found = violated(recording([straight(1, 0, 300), CROSSWALK], cars), PAPER)
    assert found["7"] == ({"R3": 2.0} if beside == "f" else {})
