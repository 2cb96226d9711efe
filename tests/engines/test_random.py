"""On random rulebooks and traces every engine says what the second reading says."""

from fractions import Fraction

from books import compile_here
from engine import is_right
from engine_table import ENGINES
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle import judged
from random_rulebooks import rulebooks
from random_traces import traces


@st.composite
def rulebooks_with_traces(draw):
    step_s = draw(st.sampled_from([Fraction(1), Fraction(1, 2)]))
    return draw(rulebooks(step_s)), step_s, draw(traces(step_s))


@given(rulebooks_with_traces())
@settings(max_examples=2 * settings.default.max_examples)
def test_all_engines_agree(drawn):
    rulebook, step_s, every = drawn
    compiled = compile_here(rulebook, step_s)
    expected = {trace.id: judged(rulebook, trace) for trace in every}
    wrong = {}
    for name, engine in ENGINES.items():
        asked = [trace for trace in every if engine.takes(trace, expected[trace.id])]
        answers = engine.judge(rulebook, compiled, asked)
        for trace, answer in zip(asked, answers, strict=True):
            should = engine.says(expected[trace.id])
            if not is_right(answer, should):
                wrong[name, trace.id] = answer, should
    assert wrong == {}
