"""Who is towed, which nobody drives: bodies of 5 m behind cars of 4 m, in steps of 0.5 s."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.drives import Drives
from rulec.extraction.traces.recorded_drive import NoDrive
from support.builders.recordings import recording, straight, vehicle


def going(number, x, mps, count=12, **more):
    """Straight on, at a constant speed or at one for each state."""
    along = x + np.cumsum(np.broadcast_to(mps, count)) * 0.5
    return vehicle(number, {k: (float(at), 0.0) for k, at in enumerate(along)}, **more)


SPEEDS = np.interp(np.arange(12), [0, 6, 11], [0.0, 15.0, 5.0])


@pytest.mark.parametrize(
    ("apart", "mps", "speeds_behind", "towed"),
    [
        (5.5, SPEEDS, SPEEDS, True),  # a drawbar of 1 m
        (7.5, SPEEDS, SPEEDS, False),  # 3 m behind
        (5.5, SPEEDS / 3, SPEEDS / 3, False),  # two in a queue that creeps
        (5.5, SPEEDS, SPEEDS * 0.93, False),  # who comes so near does not stay there
        (-5.5, SPEEDS, SPEEDS, False),  # who is ahead tows
    ],
)
def test_who_is_towed_has_no_drive(apart, mps, speeds_behind, towed):
    cars = [going(7, 50, mps), going(8, 50 - apart, speeds_behind, length=5.0)]
    drives = Drives(recording([straight(1, 0, 400)], cars), "right")
    (found,) = drives.of("8")
    assert isinstance(found, NoDrive) is towed
    assert not towed or found.why == "`7` tows it"


def test_who_has_ever_been_on_the_next_lane_is_not_towed():
    """It moves over by 3.5 m right behind the other one, which is as far away all the time."""
    along = 50 + np.cumsum(np.full(12, 6.0))
    aside = np.interp(np.arange(12), [2, 8], [3.5, 0.0])
    away = np.sqrt(5.5**2 - aside**2)
    behind = {k: (float(along[k] - away[k]), float(aside[k])) for k in range(12)}
    cars = [going(7, 50, 12.0), vehicle(8, behind, length=5.0)]
    road = [straight(1, 0, 400, left_of="2"), straight(2, 0, 400, y=4.0, right_of="1")]
    (found,) = Drives(recording(road, cars), "right").of("8")
    assert not isinstance(found, NoDrive)


def test_who_is_ego_by_the_file_is_not_towed():
    cars = [going(7, 50, SPEEDS), going(8, 44.5, SPEEDS, length=5.0)]
    found = replace(recording([straight(1, 0, 400)], cars), ego="8")
    (drive,) = Drives(found, "right").of("8")
    assert not isinstance(drive, NoDrive)


def test_who_is_there_before_is_not_towed_yet():
    cars = [going(7, 50, 12.0, 11), going(8, 44.5, 12.0, 12, length=5.0)]
    (found,) = Drives(recording([straight(1, 0, 400)], cars), "right").of("8")
    assert not isinstance(found, NoDrive)
