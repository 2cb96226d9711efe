"""Offenders and their innocent twins in tracks with noise of 0.1 m, and few or many states.

Each is driven by a formula, and differs from its twin in the fact that decides. Nothing tells of
the noise but the tracks.
"""

import numpy as np
import pytest

import rulec

NOISE_M = 0.1
MOTORWAY = {"limit_mps": 36.2, "types": ("highway", "interstate", "mainCarriageWay")}


def motorway():
    """Three lanes of one direction."""
    names = ("near", "middle", "far")
    return [
        rulec.build_lanelet(
            name,
            [(0, 3.75 * k), (3000, 3.75 * k)],
            width=3.75,
            left_of=names[k + 1] if k < 2 else None,
            right_of=names[k - 1] if k else None,
            **MOTORWAY,
        )
        for k, name in enumerate(names)
    ]


def rural(mark="solid"):
    """A lane each way with a line between them."""
    kinds = {"limit_mps": 27.78, "types": ("country",), "left_mark": mark, "right_mark": "solid"}
    return [
        rulec.build_lanelet("on", [(0, 0), (2000, 0)], **kinds),
        rulec.build_lanelet("back", [(2000, 3.5), (0, 3.5)], **kinds),
    ]


def steady(x, mps, ys=((0, 0.0),)):
    """From a place on at one speed, and its places across by time."""
    return x, mps, ys


def near_side(offends):
    """Past another one on the lane at its right, at 35 m/s against 27; or the other is faster."""
    slow, fast = steady(460, 27.0, [(0, 7.5)]), steady(400, 35.0, [(0, 3.75)])
    twin = steady(460, 27.0, [(0, 3.75)]), steady(400, 35.0, [(0, 7.5)])
    return motorway(), (fast, slow) if offends else twin


def close(offends):
    """Half a second behind another one at 33 m/s, or 2.3 s."""
    gap = 0.5 if offends else 2.3
    return motorway(), (steady(300, 33.0), steady(304.5 + gap * 33, 33.0))


def over_the_line(offends):
    """Past a slow one over a solid line, or over a broken one."""
    ys = [(0, 0.0), (6, 0.0), (8.5, 3.5), (13, 3.5), (15.5, 0.0)]
    mark = "solid" if offends else "broken"
    return rural(mark), (steady(200, 24.0, ys), steady(315, 12.0))


def fast(offends):
    """By 3 m/s too fast, or at the limit but for a hair."""
    return rural(), (steady(200, 30.8 if offends else 27.77), steady(1000, 20.0))


def seen(number, path, hz, pick):
    x, mps, ys = path
    t = np.arange(round(24 * hz)) / hz
    places = x + mps * t, np.interp(t, *zip(*ys, strict=True))
    heading = np.arctan2(np.gradient(places[1], t), mps)
    noisy = (along + pick.normal(scale=NOISE_M, size=len(t)) for along in places)
    more = {"heading": heading, "speed": np.full(len(t), mps)}
    return rulec.build_participant(number, "car", t, *noisy, step_s=1 / hz, **more)


@pytest.mark.parametrize("hz", [2, 25])
@pytest.mark.parametrize(
    ("made", "rule"),
    [
        (near_side, "near_side_passing"),
        (close, "following_distance"),
        (over_the_line, "solid_line"),
        (fast, "speed_limit"),
    ],
)
def test_noise_hides_no_offender_and_makes_none(made, rule, hz):
    found = {}
    for offends in (True, False):
        lanes, paths = made(offends)
        pick = np.random.default_rng(7)
        bodies = [seen(name, path, hz, pick) for name, path in zip("ab", paths, strict=True)]
        recording = rulec.build_recording(lanes, bodies, step_s=1 / hz, side="right")
        (row,) = rulec.verify_recording(recording, "de", rulec.RequestedDrives(("a",))).rows()
        found[offends] = rule in row["violated"]
    assert found == {True: True, False: False}
