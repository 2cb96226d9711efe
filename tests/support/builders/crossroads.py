"""Crossroads made of formulas, and bodies that drive over them by formulas."""

import numpy as np

import rulec

STEP_S = 0.1

ARMS = {
    "east": [("in_w", -200, -8), ("over", -8, 8), ("out_e", 8, 200)],
    "west": [("in_e", 200, 8), ("back", 8, -8), ("out_w", -8, -200)],
}


def crossroads(sign="YIELD", other="PRIORITY"):
    """Crossroads of roads with a lane each way; who comes along x has the one sign."""
    found = []
    for name, y in (("east", -1.75), ("west", 1.75)):
        for along in (True, False):
            ids = [f"{lane}{'' if along else '_n'}" for lane, _, _ in ARMS[name]]
            for k, (_, begin, end) in enumerate(ARMS[name]):
                # Along y it is the same, turned to the left
                line = [(begin, y), (end, y)] if along else [(-y, begin), (-y, end)]
                signs = () if k else ((sign,) if along else (other,))
                more = {"junction": "x"} if k == 1 else {}
                ways = {"successors": ids[k + 1 : k + 2], "predecessors": ids[max(k - 1, 0) : k]}
                found.append(
                    rulec.build_lanelet(
                        ids[k], line, signs=signs, types=("urban",), limit_mps=14.0, **ways, **more
                    )
                )
    return found


def driven(
    name, speeds, at, ys=((0, 0.0),), kind="car", lamp=None, turned=0, seconds=20.0, length=None
):
    """A vehicle by times (s) with speeds (m/s), at a time and place (m), and its places across.

    It goes along x, or in a direction turned to the left so many times by a right angle.
    """
    t = np.arange(round(seconds / STEP_S)) * STEP_S
    mps = np.interp(t, *zip(*speeds, strict=True))
    way = np.concatenate(([0.0], np.cumsum((mps[1:] + mps[:-1]) / 2 * STEP_S)))
    x = way + at[1] - np.interp(at[0], t, way)
    y = np.interp(t, *zip(*ys, strict=True))
    lamps = {"left_indicator": [False] * len(t), "right_indicator": [False] * len(t)}
    lamps["hazard_lights"] = [False] * len(t)
    if lamp:
        lamps[lamp[0]] = [bool(lamp[1] <= one <= lamp[2]) for one in t]
    moves = np.hypot(np.gradient(x, STEP_S), np.gradient(y, STEP_S)) > 0.1
    heading = np.where(moves, np.arctan2(np.gradient(y), np.gradient(x)), 0.0)
    heading += turned * np.pi / 2
    for _ in range(turned % 4):
        x, y = -y, x
    more = {"heading": heading, "speed": mps, "lamps": lamps, "length": length}
    return rulec.build_participant(name, kind, t, x, y, step_s=STEP_S, **more)
