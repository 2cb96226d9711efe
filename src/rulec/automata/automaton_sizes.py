"""The limits on the size of automata."""

MOST_STATES, MOST_EDGES = 20_000, 1_000_000
"""The most of an automaton while it is built, whatever it is reduced to: sizes, not times, so that
the same rules can be compiled on every machine."""

MOST_STEPS_AHEAD = 10_000
"""An automaton has at least one state per step of a bound; more steps cannot be built in time."""


class SizeError(Exception):
    """An automaton gets more than ``MOST_STATES`` or ``MOST_EDGES``, or ``MOST_STEPS_AHEAD``."""
