"""A planner that searches the smoothest way through the envelope of the cheapest maneuver."""

from itertools import pairwise

import rulec

STEP_S, START_M, MPS, GAINS = 0.5, 0.0, 10.0, (-4, -2, -1, 0, 1, 2)

maneuvers = rulec.find_maneuvers("s2", "esterle2019", step_s=STEP_S)
(envelopes,) = rulec.envelopes(maneuvers)

# (position, speed) -> the least sum of squared accelerations, and the positions on the way
reached = {(START_M, MPS): (0.0, [START_M])}
for envelope in envelopes[1:]:
    further = {}
    for (s, speed), (cost, way) in reached.items():
        for gained in GAINS:
            then = speed + gained * STEP_S
            place = round(s + (speed + then) / 2 * STEP_S, 2)
            if then < 0 or not envelope.s_min <= place <= envelope.s_max:
                continue
            known = further.get((place, then))
            if known is None or cost + gained**2 < known[0]:
                further[place, then] = cost + gained**2, [*way, place]
    reached = further

cost, way = min(reached.values())
print(f"{len(way)} places, squared accelerations {cost:g}: {way}")
assert all(own <= after for own, after in pairwise(way))
