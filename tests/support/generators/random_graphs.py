"""Random graphs of traces, by a source of chance."""

from fractions import Fraction
from itertools import pairwise
from math import lcm

from hypothesis import strategies as st

from rulec.trace import TraceGraph
from support.generators.seeds import seeds

UNIT = lcm(1, 2, 3, 4)


@st.composite
def graphs(draw, objects=("car1",)):
    """Over the small vocabulary, about cars."""
    chance = draw(seeds)

    def state():
        return {
            "place": {name: chance.choice(["near", "far", "gone"]) for name in objects},
            "p": chance.random() < 0.5,
            "q": chance.random() < 0.5,
        }

    return layered(chance, dict.fromkeys(objects, "car"), state, chance.choice([1, 2, 3, 4, 5, 5]))


def layered(chance, objects, state, n_layers):
    """A layered graph with any edges, dead ends included; margins of 1 to 4 layers or staying."""
    sizes = [chance.choice([1, 2, 3, 3, 4]) for _ in range(n_layers)]
    many = chance.choice([0.5, 0.8, 0.9, 1])
    states = [[state() for _ in range(sizes[0])]]
    for size in sizes[1:]:
        # Often one can stay where one is.
        here = [one if chance.random() < 0.8 else state() for one in states[-1]][:size]
        states.append(here + [state() for _ in range(size - len(here))])
    successors, margins = [], []
    for here, onward in pairwise(sizes):
        edges = [[one for one in range(onward) if chance.random() < many] for _ in range(here)]
        successors.append(tuple(map(tuple, edges)))
        margins.append(
            tuple(
                tuple(margin(chance, stays=one == node) for one in row)
                for node, row in enumerate(edges)
            )
        )
    weights = tuple(
        tuple(tuple(0 if m is None else UNIT // m for m in row) for row in rows) for rows in margins
    )
    present = {}
    for name in objects:
        if chance.random() < 0.5:
            first = chance.randrange(len(sizes))
            present[name] = (first, chance.randrange(first, len(sizes)))
    return TraceGraph(
        step_s=0.5,
        objects=objects,
        present=present,
        states=tuple(map(tuple, states)),
        successors=tuple(successors),
        weights=weights,
        margins=tuple(margins),
        cost_unit=Fraction(2, UNIT),
        start=chance.randrange(sizes[0]),
        goals=tuple(goal for goal in range(sizes[-1]) if chance.random() < many),
    )


def margin(chance, *, stays):
    if chance.random() < (0.8 if stays else 0.2):
        return None
    return chance.choice([1, 2, 3, 4])
