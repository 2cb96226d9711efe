"""Who passes on a ring of two lanes, and whose statute lets it do so on the near side."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_verdicts import violated
from support.builders.recordings import lanelet, recording, vehicle

OUTER_M, INNER_M, WIDTH_M, STEP_S = 22.0, 18.4, 3.6, 0.1
KNOWN = frozenset({"arrivals", "lanes", "light", "roundabout", "STOP", "YIELD", "PRIORITY"})


def ring():
    """Eight lanelets of a quarter each, by which traffic goes to the left around the middle."""
    lanes = []
    for quarter in range(4):
        turns = np.linspace(quarter, quarter + 1, 13) * np.pi / 2
        for lane, radius in enumerate((OUTER_M, INNER_M)):
            number, before, after = (1 + (quarter + k) % 4 * 2 + lane for k in (0, -1, 1))
            centre = np.stack([radius * np.cos(turns), radius * np.sin(turns)], axis=1)
            more = {"left_of": number + 1, "left_mark": "dashed", "right_mark": "solid"}
            if lane:
                more = {"right_of": number - 1, "right_mark": "dashed", "left_mark": "solid"}
            more |= {"successors": (after,), "predecessors": (before,)}
            lanes.append(lanelet(number, centre, WIDTH_M, types=frozenset({"urban"}), **more))
    return lanes


def on_ring(number, radius, mps, ahead, steps=120):
    """One that drives round, from so far (rad) on."""
    turns = ahead + mps * STEP_S * np.arange(steps) / radius
    places = np.stack([radius * np.cos(turns), radius * np.sin(turns)], axis=1)
    bodies = [
        vehicle(number, {k: tuple(places[k])}, speed=mps, heading=float(turns[k] + np.pi / 2))
        for k in range(steps)
    ]
    return replace(
        bodies[0],
        states={k: body.states[k] for k, body in enumerate(bodies)},
        outlines={k: body.outlines[k] for k, body in enumerate(bodies)},
    )


@pytest.mark.parametrize(
    ("book", "blamed"),
    # UVC 11-304(a)(2) and its copies, rule 141(1)(a): two lines of vehicles have room. R414-6 lets
    # one pass on the right who turns left, or queue beside queue
    [("us", False), ("us-ca", False), ("us-fl", False), ("au-nsw", False), ("fr", True)],
)
def test_who_passes_on_the_outer_lane_of_a_ring(book, blamed):
    """Ego, at 9 m/s, gets past one at 5 m/s on the inner lane that was 20 m ahead."""
    cars = [on_ring(7, OUTER_M, 9.0, 0.0), on_ring(8, INNER_M, 5.0, 0.9)]
    found = replace(recording(ring(), cars, step_s=STEP_S), complete=KNOWN, side="right")
    if book == "au-nsw":
        found = replace(mirrored_recording(found), side="left")
    answers = violated(found, machines(book), egos=("7",), defaults=False)
    assert ("near_side_passing" in answers["7"]) is blamed
