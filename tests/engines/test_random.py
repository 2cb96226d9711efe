"""On random rulebooks and traces every engine says what the second reading says."""

from fractions import Fraction

from books import compile_here
from engine import is_right
from engine_table import ENGINES
from hypothesis import Phase, given, settings
from oracle import Oracle
from random_rulebooks import rulebook
from random_traces import traces
from seeds import seeds


@given(seeds)
@settings(phases=[Phase.generate])
def test_all_engines_agree(chance):
    step_s = chance.choice([Fraction(1), Fraction(1, 2)])
    book, every = rulebook(chance, step_s), traces(chance, step_s)
    compiled = compile_here(book, step_s)
    oracle = Oracle(book)
    expected = {trace.id: oracle.judged(trace) for trace in every}
    wrong = {}
    for name, engine in ENGINES.items():
        asked = [trace for trace in every if engine.takes(trace, expected[trace.id])]
        answers = engine.judge(book, compiled, asked)
        for trace, answer in zip(asked, answers, strict=True):
            should = engine.says(expected[trace.id])
            if not is_right(answer, should):
                wrong[name, trace.id] = answer, should
    assert wrong == {}
