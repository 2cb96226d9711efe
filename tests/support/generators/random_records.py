"""Random rulebooks with numbers and bounds, and random states of recordings, some of them odd."""

from hypothesis import strategies as st

from rulec.monitoring.verdict import NotJudged
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from support.builders.rulebooks import rule
from support.generators.timed_formulas import TIMED_VOCABULARY, timed_formulas


@st.composite
def rulebooks(draw):
    rules = []
    for number in range(draw(st.integers(1, 3))):
        formula = draw(timed_formulas)
        variables = draw(st.sampled_from([("x: thing",), ("x: car",)]))
        strength = draw(st.sampled_from(["hard", "soft"]))
        rules.append(rule(f"r{number}", formula, *variables, strength=strength))
    semantics = draw(st.sampled_from(["stutter", "finite"]))
    return Rulebook("b", TIMED_VOCABULARY, tuple(rules), semantics=semantics)


OBJECTS = {"a": "car", "b": "thing", "c": "car"}
numbers = st.sampled_from([0, 1, 0.1, 0.3, -0.5, 1.5, 2, 1e300, 2**60, 0.30000000000000004])
places = st.sampled_from(["near", "far", "gone"])


@st.composite
def states(draw, objects, odd):
    """A state that says all there is to say, unless it is odd."""
    state = {"p": draw(st.booleans()), "q": draw(st.booleans()), "speed": draw(numbers)}
    state["place"] = {name: draw(places) for name in objects}
    state["gap"] = {name: draw(numbers) for name in objects}
    for name in draw(st.lists(st.sampled_from([*state]), max_size=1 + odd)):
        if odd or name == "p":
            state.pop(name, None)
    if odd:
        wrong = {"place": {"nobody": "near"}, "q": 1, "speed": "fast", "light": "blue", "u": True}
        key = draw(st.sampled_from([*wrong]) | st.none())
        if key is not None:
            state[key] = wrong[key]
    return state


@st.composite
def chunks(draw):
    """Traces of a few shapes that meet again in the same states, some of them odd."""
    found = []
    for shape in range(draw(st.integers(1, 2))):
        objects = {name: OBJECTS[name] for name in sorted(draw(st.sets(st.sampled_from("abc"))))}
        odd = draw(st.booleans())
        pool = draw(st.lists(states(objects, odd), min_size=1, max_size=4))
        present = {}
        shortest = 1
        for name in objects:
            if draw(st.booleans()):
                first = draw(st.integers(0, 2))
                present[name] = (first, first + draw(st.integers(0, 2)))
                shortest = max(shortest, present[name][1] + 1)
        lengths = st.integers(shortest if not odd else 0, 6)
        for number in range(draw(st.integers(1, 6))):
            n_states = draw(lengths)
            word = draw(st.lists(st.sampled_from(pool), min_size=n_states, max_size=n_states))
            found.append(Trace(f"{shape}.{number}", 1.0, objects, tuple(word), present))
    return draw(st.permutations(found))


def told(answer):
    """An answer that can be compared."""
    return (answer.trace, answer.error.diagnostics) if isinstance(answer, NotJudged) else answer
