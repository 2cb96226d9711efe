"""On random rulebooks and traces every engine says what the second reading says."""

from fractions import Fraction

from hypothesis import Phase, given, settings

from support.builders.rulebooks import compile_both_ways
from support.engines.engine import is_right
from support.engines.engine_table import ENGINES
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds
from support.oracles.rulebook_oracle import Oracle


@given(seeds)
@settings(phases=[Phase.generate])
def test_all_engines_agree(chance):
    step_s = chance.choice([Fraction(1), Fraction(1, 2)])
    book, every = rulebook(chance, step_s), traces(chance, step_s)
    compiled = compile_both_ways(book, step_s)
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
