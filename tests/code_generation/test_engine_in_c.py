"""The monitor in C finds in traces what is found here, wherever it can tell."""

import shutil
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

import rulec
from support.builders.rulebooks import compile_here
from support.engines.monitor_in_c import CEngine
from support.generators.blurred_traces import blurred
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")


@given(seeds)
@settings(phases=[Phase.generate], max_examples=max(1, settings().max_examples // 50))
def test_what_python_finds(chance):
    step_s = chance.choice([Fraction(1), Fraction(1, 2)])
    book = rulebook(chance, step_s)
    compiled = compile_here(book, step_s)
    given = list(traces(chance, step_s))
    names = {name for trace in given for state in trace.states for name in state}
    given += [blurred(chance, trace, names, most=3) for trace in given[:2]]
    engine = CEngine(compiled)
    for trace in given:
        ours = next(rulec.verify_many([trace], compiled))
        if isinstance(ours, rulec.NotJudged):
            with pytest.raises(rulec.RulecError, match=ours.error.diagnostics[0].code):
                engine.verify(trace)
        else:
            assert engine.verify(trace) in (None, ours)
    assert engine.verify(replace(given[0], ends="cut")) is None


def test_whole_traces_are_judged_in_c_at_any_step_and_unknown_values_are_not():
    book = rulec.compile_rulebook(
        rulec.parse_rulebook(
            "rulebook a signal p default false hard rule r { require always eventually[<= 1 s] p }"
        )
    )
    engine = CEngine(book)
    kept, lost = ({"p": True},), ({"p": False},) * 4
    assert engine.verify(rulec.Trace("t", 0.5, {}, kept)).satisfied is True
    assert engine.verify(rulec.Trace("t", 0.5, {}, lost)).satisfied is False
    late = [{"p": False}] * 3 + [{"p": True}]
    for step_s, satisfied in ((0.3, True), (0.4, False)):  # after 0.9 s, and after 1.2 s
        trace = rulec.Trace("t", step_s, {}, tuple(late))
        assert engine.verify(trace).satisfied is satisfied
    assert engine.verify(rulec.Trace("t", 0.5, {}, ({"p": rulec.UNKNOWN},))) is None
