"""Ego goes over the middle of a road past a car that stands, and another one comes towards it.

Lanes are 4 m wide; ego's has its middle at y = 0, so that the middle of the road is at y = 2, and
the other one keeps to y = 4. Bodies are 4 m long and 2 m wide. Ego drives 10 m/s, is at x = 0 at
0 s, and over the middle from x = 80 on to x = 120, which is from 8 s to 12 s.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.signals.conduct import oncoming_conflicts
from support.builders.drive_contexts import told_on_both_sides
from support.builders.drive_verdicts import violated
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.words import words_of

STEP_S = 0.5
TIMES = np.arange(0, 18, STEP_S)
OUT = (TIMES >= 8) & (TIMES <= 12)
FRONT_M = 82.0
"""Where ego's front is when it begins to be over the middle."""


def two_ways(**more):
    return [straight(1, 0, 600, **more), lanelet(2, [(600, 4), (0, 4)])]


def driven(number, x, y, heading=0.0, kind="car"):
    places = {
        k: (float(one), float(other)) for k, (one, other) in enumerate(zip(x, y, strict=True))
    }
    return vehicle(number, places, kind, heading=heading)


OBSTACLE = driven(9, np.full(len(TIMES), 100.0), np.full(len(TIMES), -1.0))


def ego(over_m=2.5):
    """Ego's middle is so far from its lane's middle as it goes past."""
    return driven(7, 10 * TIMES, np.where(OUT, over_m, 0.0))


def coming(room_m, brakes=(0.0, 0.0), y=4.0, mps=10.0, kind="car"):
    """One whose front is so far before ego's at 8 s, and that brakes (m/s^2) from a time (s) on."""
    hard, since = brakes
    slower = np.minimum(np.maximum(TIMES - since, 0) * hard, mps)
    way = np.cumsum(np.concatenate(([0.0], (mps - slower)[:-1] * STEP_S)))
    front = FRONT_M + room_m - (way - np.interp(8.0, TIMES, way))
    return driven(8, front + 2, np.full(len(TIMES), y), float(np.pi), kind)


def scene(other, own=None, lanes=None):
    """Both, and a car that stands at the edge, which leaves 2 m of ego's lane."""
    return recording(lanes or two_ways(), [own or ego(), other, OBSTACLE], step_s=STEP_S)


def told(other, own=None, lanes=None):
    """Whether it is held up, by state; the same in the mirror."""
    found = scene(other, own, lanes)
    rows = told_on_both_sides(words_of(oncoming_conflicts), found, ("1",))["holds_up_oncoming"]
    *of_other, of_parked = [[str(value) for value in row] for row in rows]
    assert set(of_parked) == {"False"}
    # Who stands on a lane beside ego's from start to end is no object of the drive
    return of_other[0] if of_other else of_parked


def test_one_that_has_to_brake_hard():
    """Of 60 m ego takes 40 m, and the other one needs 31 m if it brakes by 2 m/s^2 after 1 s."""
    found = told(coming(60, brakes=(5.0, 8.5)))
    assert found == ["True" if out else "False" for out in OUT]


@pytest.mark.parametrize(("brakes", "says"), [((1.5, 9.0), "?"), ((0.0, 0.0), "False")])
def test_one_that_need_not_brake_so_hard(brakes, says):
    """Of 75 m it has 35 m; as fast as it was it would be there after 3.75 s. It may have waited."""
    assert told(coming(75, brakes))[16] == says


def test_one_that_is_far_away_or_stands():
    assert set(told(coming(85))) == {"False"}
    assert set(told(coming(110, (5.0, 8.5)))) == {"False"}
    assert set(told(coming(60, mps=0.0))) == {"False"}


@pytest.mark.parametrize(
    ("room_m", "brakes"),
    # It would be there half a second after ego is back; or it got slower before ego was there, as
    # from 10 to 7 m/s, with which it comes late enough
    [(85, (5.0, 8.5)), (85, (2.0, 9.0)), (75, (1.5, 6.0)), (70, (2.0, 6.5))],
)
def test_one_that_brakes_for_no_reason_but_ego(room_m, brakes):
    """It need not brake, for ego is back in time; whether it did so for ego is open."""
    found = told(coming(room_m, brakes))
    assert found == ["?" if out else "False" for out in OUT]


def test_one_that_brakes_for_somebody_ahead():
    """11 m ahead of it another one brakes, which may be for ego; this one has to brake for that."""
    first = replace(coming(70, (2.0, 8.5)), id="6")
    found = recording(two_ways(), [ego(), coming(85, (2.0, 8.5)), first, OBSTACLE], step_s=STEP_S)
    rows = told_on_both_sides(words_of(oncoming_conflicts), found, ("1",))["holds_up_oncoming"]
    assert sum("?" in map(str, row) for row in rows) == 1


def test_one_that_ego_leaves_room_for():
    """Ego's side is 0.3 m over the middle, and the other one's 1 m from it."""
    assert set(told(coming(60, (5.0, 8.5)), ego(1.3))) == {"False"}


def test_a_sign_lets_ego_go_first():
    signed = two_ways(signs=frozenset({"PRIORITY_OVER_ONCOMING"}))
    assert set(told(coming(60, (5.0, 8.5)), lanes=signed)) == {"False"}


def test_one_that_ego_runs_into():
    assert told(coming(40))[16] == "True"


def test_a_cycle_that_has_to_brake():
    assert told(coming(60, brakes=(5.0, 8.5), kind="bicycle"))[16] == "True"


def test_one_that_comes_on_ego_s_half_is_not_on_its_own():
    assert set(told(coming(60, (5.0, 8.5), y=2.5))) == {"False"}


def test_one_of_which_nobody_knows_whether_it_turns_off():
    """It brakes, and its track ends where it stands, 20 m before it would have met ego."""
    gone = coming(60, brakes=(5.0, 8.5))
    until = {k: state for k, state in gone.states.items() if k < 22}
    gone = replace(gone, states=until, outlines={k: gone.outlines[k] for k in until})
    assert told(gone)[16] == "?"


def test_a_recording_that_ends_while_ego_is_over_the_middle():
    short = ego()
    until = {k: state for k, state in short.states.items() if k < 20}
    short = replace(short, states=until, outlines={k: short.outlines[k] for k in until})
    assert told(coming(60), short)[16] == "?"
    # At 9.5 s 90 m are left, of which both together drive 80 m in the 4 s that a way back takes
    assert told(coming(120), short)[16] == "False"


@pytest.mark.parametrize(("room_m", "since"), [(60, 8.0), (110, None)])
def test_the_law_past_obstacles_is_judged(room_m, since):
    for book in ("de", "vienna", "us-tx"):
        found = violated(scene(coming(room_m, (5.0, 8.5))), machines(book), egos=("7",))
        assert found["7"].get("passing_obstacles") == since
