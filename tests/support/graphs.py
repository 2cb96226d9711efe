"""Random graphs of traces over the small vocabulary."""

from fractions import Fraction
from itertools import pairwise
from math import lcm

from hypothesis import strategies as st

from rulec.trace import TraceGraph


@st.composite
def graphs(draw, objects=("car1",)):
    """A layered graph with any edges, dead ends included; margins of 1 to 4 layers or staying."""
    per_state = st.fixed_dictionaries(
        {
            "place": st.fixed_dictionaries(
                {name: st.sampled_from(["near", "far", "gone"]) for name in objects}
            ),
            "p": st.booleans(),
            "q": st.booleans(),
        }
    )
    sizes = draw(st.lists(st.integers(1, 4), min_size=1, max_size=5))
    layers = tuple(tuple(draw(per_state) for _ in range(size)) for size in sizes)
    successors, margins = [], []
    for here, onward in pairwise(sizes):
        edges = [sorted(draw(st.sets(st.integers(0, onward - 1)))) for _ in range(here)]
        successors.append(tuple(tuple(row) for row in edges))
        margins.append(
            tuple(tuple(draw(st.sampled_from([None, 1, 2, 3, 4])) for _ in row) for row in edges)
        )
    unit = lcm(1, 2, 3, 4)
    weights = tuple(
        tuple(tuple(0 if m is None else unit // m for m in row) for row in rows) for rows in margins
    )
    present = {}
    for name in objects:
        if draw(st.booleans()):
            first = draw(st.integers(0, len(sizes) - 1))
            present[name] = (first, draw(st.integers(first, len(sizes) - 1)))
    return TraceGraph(
        step_s=0.5,
        objects=dict.fromkeys(objects, "car"),
        present=present,
        states=layers,
        successors=tuple(successors),
        weights=weights,
        margins=tuple(margins),
        cost_unit=Fraction(2, unit),
        start=draw(st.integers(0, sizes[0] - 1)),
        goals=tuple(sorted(draw(st.sets(st.integers(0, sizes[-1] - 1))))),
    )
