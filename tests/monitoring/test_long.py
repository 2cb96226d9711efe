"""Long traces, run in pieces: every answer is the one of a machine that reads letter by letter."""

from random import Random
from unittest import mock

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.monitoring.batch import batch_verify
from rulec.monitoring.batch.batch_verify import verify_chunk
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.machines import table_run
from rulec.monitoring.batch.machines.table_run import visited
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from support.builders.rulebooks import Q, always, compile_here, eventually, far, implies, near, rule
from support.generators.random_records import chunks, rulebooks, told
from support.generators.timed_formulas import TIMED_VOCABULARY


@given(
    st.integers(1, 40),
    st.integers(1, 5),
    st.integers(1, 3000),
    st.randoms(use_true_random=False),
)
@example(1, 1, 1, Random(0))
@example(32, 2, table_run.FEWEST_STEPS, Random(0))
@example(33, 2, table_run.FEWEST_STEPS, Random(0))
@example(2, 2, table_run.FEWEST_STEPS - 1, Random(0))
def test_states_are_those_that_are_passed_one_by_one(n_states, n_letters, length, chance):
    following = [[chance.randrange(n_states) for _ in range(n_letters)] for _ in range(n_states)]
    word = [chance.randrange(n_letters) for _ in range(length)]
    state, expected = 0, []
    for letter in word:
        expected.append(state)
        state = following[state][letter]
    assert visited(following, np.array(word, dtype=np.uint8)).tolist() == expected


@given(rulebooks(), chunks())
def test_answers_are_those_of_the_traces_alone(rulebook, traces):
    """As if any trace were long."""
    compiled = compile_here(rulebook)
    alone = [told(verify_or_reason(trace, compiled)) for trace in traces]
    with mock.patch.object(table_run, "FEWEST_STEPS", 1):
        assert [told(one) for one in verify_chunk(traces, compiled)] == alone


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@pytest.mark.parametrize("lost", [None, 0, 1, 1500, 2999])
def test_one_long_trace(semantics, lost, monkeypatch):
    rules = (
        rule("apart", always(implies(near("v"), far("w"))), "v: car", "w: car"),
        rule("in time", always(implies(Q, eventually(far("v")))), "v: car"),
    )
    compiled = compile_here(Rulebook("b", TIMED_VOCABULARY, rules, semantics=semantics))
    states = [{"q": n % 7 == 0, "place": {"a": "near", "b": "far"}} for n in range(3000)]
    if lost is not None:
        states[lost] = {**states[lost], "place": {"a": "near", "b": "gone"}}
    trace = Trace("t", 1.0, {"a": "car", "b": "car"}, tuple(states))
    expected = verify_or_reason(trace, compiled)
    found = [(one.rule, one.binding, one.step) for one in expected.violations]
    late = [("in time", {"v": "a"}, None)]
    early = [] if lost is None else [("apart", {"v": "a", "w": "b"}, lost)]
    assert found == early + late
    monkeypatch.setattr(
        batch_verify, "verify_or_reason", lambda *_: pytest.fail("it was judged state by state")
    )
    assert verify_chunk([trace], compiled) == [expected]
