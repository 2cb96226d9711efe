"""Many traces together: every answer is the one that the trace gets alone."""

from fractions import Fraction

import numpy as np
import pytest
from books import compile_here, rule
from hypothesis import example, given, settings
from hypothesis import strategies as st
from timed import SUMS, TIMED_VOCABULARY, timed_formulas

from rulec.automata.machine import NumberRead, Threshold
from rulec.diagnostics import Diagnostic, RulecError
from rulec.rulebook.model import Rulebook
from rulec.runtime.batch.gathering import OddError, gathered
from rulec.runtime.batch.grouping import grouped
from rulec.runtime.batch.judging import judge_cells, judge_columns
from rulec.runtime.batch.reading import NotGivenError
from rulec.runtime.batch.sums import digits_of_sum
from rulec.runtime.batch.verifying import judge_chunk, verify_many
from rulec.runtime.verdict import NotJudged, Verdict
from rulec.runtime.verify import judge, verify
from rulec.trace import Trace

HEADS = [(), ("x: thing",), ("x: car",)]


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
    return (answer.trace, answer.error.diagnostics) if isinstance(answer, NotJudged) else answer


@given(rulebooks(), chunks())
@settings(max_examples=settings.default.max_examples // 2)
def test_answers_are_those_of_the_traces_alone(rulebook, traces):
    compiled = compile_here(rulebook)
    alone = [told(judge(trace, compiled)) for trace in traces]
    assert [told(one) for one in judge_chunk(traces, compiled, fewest=1)] == alone


@given(rulebooks(), chunks())
@settings(max_examples=settings.default.max_examples // 2)
def test_cells_and_columns_say_the_same(rulebook, traces):
    """Whether states are told apart as a whole, or by what is read of them."""
    compiled = compile_here(rulebook)
    sound = [one for one in traces if isinstance(judge(one, compiled), Verdict)]
    sound = [one for one in sound if one.objects == sound[0].objects]
    sound = [one for one in sound if one.present == sound[0].present]
    if not sound:
        return
    group = grouped(sound)
    engines = [judge_cells(group.cells, compiled)]
    try:
        engines.append(judge_columns(gathered(group.cells, TIMED_VOCABULARY), compiled))
    except (OddError, NotGivenError):
        pass
    ordered = [verify(sound[place], compiled) for place in group.order]
    for judged in engines:
        found = [[] for _ in sound]
        for one in judged:
            assert not len(one.unread)
            for trace, step in zip(one.violated, one.lost_at(), strict=True):
                step = None if step < 0 else step
                found[trace].append((one.task.rule.name, one.task.objects, step))
        assert found == [[(v.rule, v.binding, v.step) for v in one.violations] for one in ordered]
