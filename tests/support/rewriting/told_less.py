"""A recording of the same traffic of which less is said: nothing sure becomes the opposite."""

import random
from collections.abc import Callable
from dataclasses import replace

from rulec.recordings.recording import REGULATING, ObservedLight, Recording, Weather


def _of_lanelets(recording, change):
    return replace(recording, lanelets={k: change(x) for k, x in recording.lanelets.items()})


def without_lamps(recording, pick):
    """Of half of them nobody knows what they showed."""
    dark = {"lamps": {}, "shows": frozenset()}
    bodies = [replace(x, **dark) if pick.random() < 0.5 else x for x in recording.participants]
    return replace(recording, participants=tuple(bodies))


def without_limits(recording, _pick):
    return _of_lanelets(recording, lambda x: replace(x, limit_mps=None, minimum_mps=None))


def without_marks(recording, pick):
    def lanelet(one):
        gone = [side for side in ("left_mark", "right_mark") if pick.random() < 0.5]
        return replace(one, **dict.fromkeys(gone))

    return _of_lanelets(recording, lanelet)


def with_doubtful_signs(recording, pick):
    """Nobody knows whether the signs of some lanelets are there."""

    def lanelet(one):
        if pick.random() < 0.5:
            return one
        return replace(one, signs=frozenset(), untold_signs=one.untold_signs | one.signs)

    return _of_lanelets(recording, lanelet)


def without_signs(recording, _pick):
    """Nobody knows of signs who goes first."""
    doubt = {"signs": frozenset(), "untold_signs": REGULATING}
    whole = replace(recording, complete=recording.complete - REGULATING)
    return _of_lanelets(whole, lambda x: replace(x, **doubt))


def with_lights_out_of_sight(recording, pick):
    """What lights show is not known for some seconds."""
    steps = sorted({step for body in recording.participants for step in body.outlines})

    def light(one):
        gone = pick.choice(steps)
        hidden = range(gone, gone + round(4 / recording.step_s))
        seen = {step: one.colour_at(step) for step in steps if step not in hidden}
        return ObservedLight({step: colour for step, colour in seen.items() if colour})

    def lanelet(one):
        to = {name: light(own) for name, own in one.lights_to.items()}
        return replace(one, lights=tuple(map(light, one.lights)), lights_to=to)

    return _of_lanelets(recording, lanelet)


def without_ways_that_go_first(recording, _pick):
    return _of_lanelets(recording, lambda x: replace(x, foes=None, first=None))


def incomplete(recording, _pick):
    """What is not in it may be there all the same, and its weather is not known."""
    return replace(recording, complete=frozenset(), weather=Weather())


TOLD_LESS: dict[str, Callable[[Recording, random.Random], Recording]] = {
    one.__name__: one
    for one in (
        *(without_lamps, without_limits, without_marks, with_doubtful_signs, without_signs),
        *(with_lights_out_of_sight, without_ways_that_go_first, incomplete),
    )
}
