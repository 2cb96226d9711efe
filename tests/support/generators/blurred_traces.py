"""Random traces in which some values are unknown, or intervals."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from rulec.vocabulary import Quantity
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.full_vocabulary import WORLD
from support.generators.random_rulebooks import LIMITS
from support.generators.random_traces import NUMBERS
from support.oracles.completion_oracle import put


def places_of(trace):
    for number, state in enumerate(trace.states):
        for name, value in state.items():
            yield from _within(number, name, (), value)


def _within(number, name, objects, value):
    if isinstance(value, dict):
        for one, inner in value.items():
            yield from _within(number, name, (*objects, one), inner)
    else:
        yield number, name, objects


def blurred(chance, trace, names, most=6):
    """The trace with a few values unknown, mostly of ``names``; one at most is a number."""
    places = [place for place in places_of(trace) if place[1] in names or chance.random() < 0.1]
    chance.shuffle(places)
    numeric = [place for place in places if isinstance(WORLD.declarations[place[1]], Quantity)]
    others = [place for place in places if place not in numeric]
    chosen = [*numeric[: chance.randint(0, 1)], *others[: chance.randint(0, most)]]
    states = list(trace.states)
    for number, name, objects in chosen:
        value = UNKNOWN
        if (number, name, objects) in numeric and chance.random() < 0.5:
            low, high = sorted(chance.choices([0, 0.1, 0.3, 1, 1.5, 2, -0.5], k=2))
            value = Interval(low, high)
        states[number] = put(states[number], name, objects, value)
    return replace(trace, states=tuple(states))


def telling_numbers():
    """Numbers on all sides of whatever sums a random rule compares with its limits."""
    known = [Fraction(repr(float(number))) for number in NUMBERS if abs(number) < 10]
    edges = set(LIMITS)
    for limit in LIMITS:
        for number in known:
            edges |= {limit + 2 * number, (number - limit) / 2, limit + number, number - limit}
    ordered = sorted(edges)
    between = [(low + high) / 2 for low, high in pairwise(ordered)]
    far = Fraction(10) ** 301
    return [-far, ordered[0] - 1, *ordered, *between, ordered[-1] + 1, far]
