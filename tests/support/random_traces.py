"""Random traces over the vocabulary of the random rulebooks, and the names that they leave out."""

from hypothesis import strategies as st
from random_rulebooks import WORLD

from rulec.trace import Trace

KINDS = {"a": "car", "b": "thing", "c": "car"}
NUMBERS = [0, 1, 0.1, 0.3, -0.5, 1.5, 2, 0.30000000000000004, 2.0, 1e300]
VALUES = {
    "place": ["near", "far", "gone"],
    "light": ["red", "green"],
    "speed": NUMBERS,
    "pace": NUMBERS,
    "gap": NUMBERS,
    "apart": NUMBERS,
}


@st.composite
def states(draw, objects, *, gaps):
    """All that has no default, and some of what has; with ``gaps`` not quite all."""
    state = {}
    for name, declaration in WORLD.declarations.items():
        values = st.sampled_from(VALUES.get(name, [True, False]))
        if declaration.default is not None and draw(st.booleans()):
            continue
        if gaps and draw(st.integers(0, 9)) == 0:
            continue
        said = said_about(draw, values, objects, len(declaration.parameters))
        if said != {}:
            state[name] = said
    return state


def said_about(draw, values, objects, n_objects):
    if n_objects == 0:
        return draw(values)
    return {name: said_about(draw, values, objects, n_objects - 1) for name in objects}


def only(state, there):
    """What a state says of the world and of those who are there."""
    return {
        name: of_these(value, there) if isinstance(value, dict) else value
        for name, value in state.items()
    }


def of_these(value, there):
    if not isinstance(value, dict):
        return value
    return {name: of_these(inner, there) for name, inner in value.items() if name in there}


@st.composite
def traces(draw, step_s, n_traces=6):
    """Of one or two shapes; objects come late and leave early, and states are met again."""
    found = []
    for shape in range(draw(st.integers(1, 2))):
        objects = {name: KINDS[name] for name in sorted(draw(st.sets(st.sampled_from("abc"))))}
        pool = draw(st.lists(states(objects, gaps=draw(st.booleans())), min_size=1, max_size=4))
        shortest, present = 1, {}
        for name in objects:
            if draw(st.integers(0, 2)) == 0:
                first = draw(st.integers(0, 2))
                present[name] = (first, first + draw(st.integers(0, 2)))
                shortest = max(shortest, present[name][1] + 1)
        for number in range(draw(st.integers(1, n_traces))):
            n = draw(st.integers(shortest, max(shortest, 5)))
            word = draw(st.lists(st.sampled_from(pool), min_size=n, max_size=n))
            there = [
                [
                    one
                    for one in objects
                    if one not in present or present[one][0] <= t <= present[one][1]
                ]
                for t in range(n)
            ]
            word = tuple(only(state, names) for state, names in zip(word, there, strict=True))
            found.append(Trace(f"{shape}.{number}", float(step_s), objects, word, present))
    return found
