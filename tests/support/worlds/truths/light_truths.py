"""Red lights: the letter of the link while the front crosses the end of the lane before it."""

from support.worlds.facts import Fact

_AROUND = 1
"""Every second state is recorded."""

_RED, _OTHER = frozenset("r"), frozenset("us")
"""Red with amber, and red with an arrow to the right, are other matters."""


def red_light_facts(world):
    """Crossings at red; unsure within a step of a change."""
    for crossing in world.crossings:
        link = crossing.link
        if not link.light:
            continue
        step = crossing.track.step[crossing.row]
        states = world.lights[link.light]
        around = [states[k] for k in range(step - 1 - _AROUND, step + _AROUND + 1) if k in states]
        letters = {state[link.light_index] for state in around}
        if letters & (_RED | _OTHER):
            at = world.time(crossing.track, crossing.row)
            yield Fact(crossing.track.id, "red_light", at, at, letters <= _RED)
