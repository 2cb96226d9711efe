"""Scenes whose facts another monitor labels, vehicle by vehicle, judged by German law.

Who is where, and how fast, is as in the tests of CommonRoad's crmonitor (R_G1 to R_I5, the rules of
Maierhofer et al., IV 2020), its lanes 3.5 m wide. What is expected is what the StVO says; where
that is not the label, the scene says why.
"""

from dataclasses import replace

import numpy as np
import pytest

import rulec
from rulec.recordings.recording import BROAD_LEFT

STEP_S, SECONDS, WIDE_M = 0.1, 5.0, 3.5
T = np.arange(round(SECONDS / STEP_S) + 1) * STEP_S


def motorway(*kinds, ends=1000.0):
    """Lanes along x from the right one on, each of one of these types; y = 0 is its right edge."""
    found = []
    for k, kind in enumerate(kinds):
        y = (k + 0.5) * WIDE_M
        types = ("interstate", *kind.split())
        sides = {"left_of": k + 1 if k + 1 < len(kinds) else None, "right_of": k - 1 if k else None}
        found.append(rulec.build_lanelet(k, [(-500, y), (ends, y)], WIDE_M, types=types, **sides))
    return found


def steady(name, mps, x, y):
    """A car at one speed."""
    return moving(name, x + mps * T, y + 0.0 * T, mps + 0.0 * T)


def moving(name, x, y, mps, heading=None):
    heading = 0.0 * T if heading is None else heading
    size = {"length": 4.508, "width": 1.61}
    return rulec.build_participant(
        name, "car", T, x, y, step_s=STEP_S, heading=heading, speed=mps, **size
    )


def braking(name, mps, x, y, mps2, after_s=1.0):
    speed = mps - mps2 * np.maximum(T - after_s, 0.0)
    way = np.concatenate(([0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * STEP_S)))
    return moving(name, x + way, y + 0.0 * T, speed)


MAIN = "mainCarriageWay"
QUEUE = [
    steady(f"queue {k}", mps, x, 5.25)
    for k, (mps, x) in enumerate([(1, 3), (2, 13), (0, 33), (1, 43), (1.5, 53), (1, 63), (2, 73)])
]


def reverses_and_turns():
    """R_I3. One backs after it stopped, one all the time, one turns round, one drives on."""
    back = 2.0 - 5.0 * np.clip(T - 1.2, 0.0, 2.5)
    way = np.concatenate(([0.0], np.cumsum((back[1:] + back[:-1]) / 2 * STEP_S)))
    angle = np.minimum(T / 3.2, 1.0) * np.pi
    past = np.maximum(T - 3.2, 0.0) * 5.0
    bodies = [
        moving("backs", 50 + way, 1.75 + 0 * T, back),
        moving("backed", 100 - 10 * T, 1.75 + 0 * T, -10 + 0 * T),
        moving(
            "turns", 125 + 5.1 * np.sin(angle) - past, 6.85 - 5.1 * np.cos(angle), 5 + 0 * T, angle
        ),
        steady("drives", 20, 140, 1.75),
    ]
    found = {"reversing_on_motorways": {"backs", "backed"}, "turning_on_motorways": {"turns"}}
    return motorway(*[MAIN] * 4), bodies, found


def passes_a_queue():
    """R_I2. § 7(2a): past one on the left slightly faster, by 18 km/h, but not at 72 km/h."""
    bodies = [steady("slow", 5, 3, 1.75), steady("fast", 20, 13, 1.75), *QUEUE]
    return motorway(MAIN, MAIN), bodies, {"near_side_passing": {"fast"}}


def passes_on_the_right():
    """R_I2. One gets past on the right lane; another one is as fast, but not past by the end."""
    bodies = [steady("past", 25, 40, 1.75), steady("on the left", 15, 60, 5.25)]
    return (
        motorway(MAIN, MAIN),
        [*bodies, steady("behind", 20, 5, 1.75)],
        {"near_side_passing": {"past"}},
    )


def passes_on_a_ramp():
    """R_I2. § 7a(2): who joins may be faster than those on the road, of whom one is, too."""
    lanes = motorway("accessRamp", MAIN, MAIN)
    bodies = [steady("joins", 25, 25, 1.75), steady("right", 20, 40, 5.25)]
    bodies += [steady("passes", 20, 3, 5.25), steady("left", 15, 10, 8.75)]
    return lanes, bodies, {"near_side_passing": {"passes"}}


def passes_beyond_a_broad_line():
    """R_I2. § 7a(1): right of it one may be faster, to leave; left of it one may not."""
    lanes = motorway(*[MAIN] * 4)
    lanes[1] = replace(lanes[1], types=lanes[1].types | {BROAD_LEFT})
    bodies = [steady("leaves", 20, 5, 5.25), steady("stays", 28.5, 5, 8.75)]
    return lanes, [*bodies, steady("left", 10, 50, 12.25)], {"near_side_passing": {"stays"}}


def forms_a_path():
    """R_I4. The label wants all but the left lane at the right edge; § 11(2) the lane beside it.

    Who is on the right of three lanes is in nobody's way, wherever it keeps in its lane.
    """
    places = {"right edge": 4.35, "right": 5.35, "middle edge": 7.9, "middle": 8.75}
    places |= {"left edge": 13.15, "left": 12.15, "shoulder": 2.0}
    bodies = [
        steady(f"{name} {k}", 1, x, y)
        for name, y in places.items()
        for k, x in enumerate(range(20, 90, 10))
    ]
    # Of the foremost nobody knows what is ahead of it
    late = {f"{name} {k}" for name in ("middle", "left") for k in range(6)}
    lanes = motorway("shoulder", MAIN, MAIN, MAIN)
    driven = {f"shoulder {k}" for k in range(7)}
    return lanes, bodies, {"emergency_corridor": late, "hard_shoulder": driven}


def rolls_out_on_the_shoulder():
    """§ 2(1) s. 2: who slows down there to stand may have broken down; who keeps its speed not."""
    bodies = [braking("rolls out", 12, 40, 1.75, 2.0, after_s=-1.0), steady("on", 12, 200, 1.75)]
    return motorway("shoulder", MAIN, MAIN), bodies, {"hard_shoulder": {"on"}}


def brakes_alone():
    """R_G2. § 4(1) s. 2 binds who is ahead: with nobody behind nobody is endangered."""
    bodies = [braking("brakes", 30, 40, 1.75, 2.5), steady("follows", 30, 10, 5.25)]
    bodies += [steady("far", 30, 400, 1.75)]
    return motorway(MAIN, MAIN), bodies, {"needless_braking": set()}


def follows_closely():
    """R_G1. 5.5 m at 30 m/s, and 20 m/s behind 10 m/s, are too little; 32.5 m at 20 m/s are not."""
    bodies = [steady("near", 30, 3, 1.75), steady("ahead", 30, 13, 1.75)]
    bodies += [steady("nears", 20, 3, 5.25), steady("slow", 10, 62, 5.25)]
    bodies += [steady("keeps", 20, 3, 8.75), steady("leads", 20, 40, 8.75)]
    return motorway(*[MAIN] * 3), bodies, {"following_distance": {"near", "nears"}}


def stands_in_a_jam():
    """R_I1. § 18(8): who stands in it, or behind one that stands, has a reason."""
    bodies = [*QUEUE, steady("behind", 0, 3, 1.75), steady("stands", 0, 13, 1.75)]
    return motorway(MAIN, MAIN), bodies, {"stopping_on_motorways": set()}


@pytest.mark.parametrize(
    "made",
    [
        *(reverses_and_turns, passes_a_queue, passes_on_the_right, passes_on_a_ramp),
        *(passes_beyond_a_broad_line, forms_a_path, brakes_alone, follows_closely),
        *(stands_in_a_jam, rolls_out_on_the_shoulder),
    ],
)
def test_those_violate_a_rule_who_do_and_nobody_else(made):
    lanes, bodies, expected = made()
    found = rulec.build_recording(lanes, bodies, step_s=STEP_S, side="right")
    rows = [*rulec.verify_recording(found, "de").rows()]
    assert {row["ego"] for row in rows} == {body.id for body in bodies}
    for rule, violators in expected.items():
        assert {row["ego"] for row in rows if rule in row["violated"]} == violators, rule
