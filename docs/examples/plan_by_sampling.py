"""A planner that samples accelerations and lanes, and drives the sample that violates least."""

import numpy as np

import rulec

STEP_S, STATES = 0.5, 8

street = {"types": ["urban"], "limit_mps": 50 / 3.6}
lanes = [
    rulec.build_lanelet("right", [(0, 0), (400, 0)], left_of="left", **street),
    rulec.build_lanelet("left", [(0, 3.5), (400, 3.5)], right_of="right", **street),
]
t = STEP_S * np.arange(20)
ego = rulec.build_participant("ego", "car", t[:4], 20 + 13 * t[:4], 0 * t[:4], step_s=STEP_S)
slow = rulec.build_participant("slow", "car", t, 70 + 5 * t, 0 * t, step_s=STEP_S)
recording = rulec.build_recording(lanes, [ego, slow], step_s=STEP_S, side="right")
world = rulec.TrafficWorld(recording, "ego")

x, y, heading, speed = world.past[-1]
ahead = STEP_S * np.arange(1, STATES + 1)
samples = []
for gained in np.linspace(-3, 1, 9):
    for side in (0.0, 3.5):
        moved = speed * ahead + gained * ahead**2 / 2
        across = y + side * np.minimum(ahead / 3, 1)
        turned = np.arctan2(np.gradient(across), np.gradient(moved))
        samples.append(np.column_stack((x + moved, across, turned, speed + gained * ahead)))

found = rulec.score(samples, world, "de", after=world.past)
chosen = max(range(len(found)), key=lambda k: (-found.places[k], samples[k][-1][0]))
print(f"{sum(found.allowed)} of {len(found)} allowed; chosen: {samples[chosen][-1].round(1)}")
assert "following_distance" not in [one.rule for one in found.candidates[chosen].violations]
