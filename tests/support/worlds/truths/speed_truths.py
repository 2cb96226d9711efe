"""Speeding: SUMO's speed against the limit of its lane."""

import numpy as np

from support.worlds.facts import graded

_SURELY_MPS = 0.1
_LEAST_S = 1.0
_AROUND_S = 0.7
"""Where exactly one limit ends is a matter of where on the body one looks."""


def speed_facts(world):
    """Faster than the limit; sure by 0.1 m/s for a second, by all limits around."""
    reach = round(_AROUND_S / world.step_s)
    for track in world.vehicles.values():
        limits = np.array([world.net.legal_speed(lane) for lane in track.lane])
        around = np.lib.stride_tricks.sliding_window_view(
            np.pad(limits, reach, mode="edge"), 2 * reach + 1
        )
        speed = track.column("speed")
        sure = speed > around.max(axis=1) + _SURELY_MPS
        masks = (sure, speed > around.min(axis=1), _LEAST_S)
        yield from graded(world, track, "speed_limit", masks)
