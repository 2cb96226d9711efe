"""Random rulebooks with numbers and bounds, and random states of recordings, some of them odd."""

from books import rule
from hypothesis import strategies as st
from timed import TIMED_VOCABULARY, timed_formulas

from rulec.rulebook.model import Rulebook


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
