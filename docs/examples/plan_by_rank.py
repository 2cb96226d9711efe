"""A planner without learning or weights: it drives the best-ranked of a few motion primitives."""

import numpy as np

import rulec

STEP_S, AHEAD = 0.5, 0.5 * np.arange(1, 9)

lane = rulec.build_lanelet("east", [(0, 0), (600, 0)], types=["urban"], limit_mps=50 / 3.6)
t = STEP_S * np.arange(40)
slow = rulec.build_participant("slow", "car", t, 60 + 6 * t, 0 * t, step_s=STEP_S)
rules = rulec.compile_rulebook("de")
driven = [(10 + 12 * STEP_S * k, 0.0, 0.0, 12.0) for k in range(4)]

for _ in range(4):
    x, y, _, speed = np.transpose(driven)
    now = STEP_S * np.arange(len(driven))
    ego = rulec.build_participant("ego", "car", now, x, y, speed=speed, step_s=STEP_S)
    recording = rulec.build_recording([lane], [ego, slow], step_s=STEP_S, side="right")
    primitives = []
    for gained in (1.0, 0.0, -1.0, -2.0, -3.0):  # the fastest first
        speeds = np.maximum(speed[-1] + gained * AHEAD, 0.0)
        places = x[-1] + np.cumsum(speeds) * STEP_S
        primitives.append(np.column_stack((places, 0 * AHEAD, 0 * AHEAD, speeds)))
    found = rulec.score(primitives, rulec.TrafficWorld(recording, "ego"), rules, after=driven)
    driven += [tuple(row) for row in primitives[found.best][:2].tolist()]
    print(f"{driven[-1][3]:.1f} m/s, {len(found)} candidates, places {found.places.tolist()}")

assert 0 < driven[-1][3] < driven[0][3]
