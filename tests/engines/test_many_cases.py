"""On a million random traces the engines and the checker say what the second reading says."""

import os
import random
from collections import Counter
from fractions import Fraction

import pytest

from rulec.api.named_monitor import Monitor
from rulec.automata.bundle.bundle_file import from_json, to_json
from rulec.diagnostics import RulecError
from rulec.validation.file_proof import proofs_of
from support.builders.rulebooks import compile_both_ways
from support.engines.engine import code_of, is_right
from support.engines.engine_table import ENGINES
from support.engines.monitor_engines import ended
from support.engines.trace_engines import stacked, together
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import beginnings
from support.oracles.presence import there
from support.oracles.rulebook_oracle import Oracle, Refused

PARTS, CASES = (100, 10_000) if os.environ.get("RULEC_TEST_PROFILE") == "long" else (1, 300)
SHAPES, EACH = (4, 60) if CASES > 300 else (2, 5)
"""Shapes of traces for a rulebook, and traces of each: compiling takes longer than judging one."""
A_FEW = 20
"""Cases of a rulebook that one of the engines is asked which take a file or a process for them."""

UNREAD = ("its words compare numbers of different dimensions", "this checker cannot read")
"""Why some of these rules are not proved: their words are made up, and have no units."""


def of_a_file(rulebook, compiled, traces):
    """In arrays, by what was saved and read again."""
    return stacked(rulebook, from_json(to_json(compiled).encode(), "book.json"), traces)


ASKED = {"together": together, "compiled file, in arrays": of_a_file}
"""What is asked for every case, beside a monitor that runs."""
OTHERS = [name for name in ENGINES if name not in {"second reading", "monitor"}]


@pytest.mark.parametrize("part", range(PARTS))
def test_engines_and_the_checker_agree(part, record_property):
    """A case is a trace of a rulebook, judged by all that are asked; tables are proved."""
    chance = random.Random(f"cases {part}")
    tried, proved, came = 0, 0, Counter()
    while tried < CASES:
        step_s = chance.choice([Fraction(1), Fraction(1, 2)])
        book = rulebook(chance, step_s)
        compiled = compile_both_ways(book, step_s)
        reasons = [one.because for one in proofs_of(to_json(compiled).encode())]
        assert [one for one in reasons if one and not one.startswith(UNREAD)] == []
        proved += reasons.count("")
        oracle = Oracle(book)
        for _ in range(SHAPES):
            rows = [up_to_refusal(row, oracle) for row in beginnings(chance, step_s, EACH)]
            every = [trace for row in rows for trace, _ in row]
            expected = [said for row in rows for _, said in row]
            answers = {name: judge(book, compiled, every) for name, judge in ASKED.items()}
            answers["monitor"] = [
                one for row in rows for one in watched(compiled, [trace for trace, _ in row])
            ]
            wrong = [
                (name, trace, answer, should)
                for name, said in answers.items()
                for trace, answer, should in zip(every, said, expected, strict=True)
                if not is_right(answer, should)
            ]
            assert wrong == []
            tried += len(every)
            came.update(bool(one) for one in expected if isinstance(one, tuple))
        other = chance.choice(OTHERS)
        some = chance.sample(range(len(every)), min(A_FEW, len(every)))
        asked = [(every[n], expected[n]) for n in some]
        assert wrong_of(ENGINES[other], book, compiled, asked) == [], other
    assert proved
    assert came[True]
    assert came[False]
    record_property("cases", tried)


def up_to_refusal(row, oracle):
    """The traces with what should be said of them; what goes on after a refusal is refused, too."""
    found = []
    for trace in row:
        found.append((trace, oracle.judged(trace)))
        if isinstance(found[-1][1], Refused):
            break
    return found


def watched(compiled, row):
    """What one monitor says at the end of each of a trace's beginnings."""
    longest, answers, refused = row[-1], {}, ""
    monitor = Monitor(compiled, longest.step_s)
    wanted = {len(trace.states) for trace in row}
    for n, state in enumerate(longest.states):
        try:
            refused or monitor.step(state, there(longest, n))
        except RulecError as error:
            refused = code_of(error)
        if n + 1 in wanted:
            answers[n + 1] = refused or ended(monitor, compiled)
    return [answers[len(trace.states)] for trace in row]


def wrong_of(engine, book, compiled, asked):
    asked = [(trace, expected) for trace, expected in asked if engine.takes(trace, expected)]
    answers = engine.judge(book, compiled, [trace for trace, _ in asked])
    return [
        (trace, answer, expected)
        for (trace, expected), answer in zip(asked, answers, strict=True)
        if not is_right(answer, engine.says(expected))
    ]
