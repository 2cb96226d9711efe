"""On a million random traces the engines and the checker say what the second reading says."""

import os
import random
from dataclasses import replace
from fractions import Fraction

import pytest

from rulec.automata.bundle.bundle_file import to_json
from rulec.validation.file_proof import proofs_of
from support.builders.rulebooks import compile_here
from support.engines.engine import is_right
from support.engines.engine_table import ENGINES
from support.engines.trace_engines import together
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.oracles.rulebook_oracle import Oracle

PARTS, CASES = (100, 10_000) if os.environ.get("RULEC_TEST_PROFILE") == "long" else (1, 300)
EACH = 30
"""Times that traces are drawn for a rulebook: compiling it takes longer than judging one."""

UNREAD = ("its words compare what cannot be compared", "this checker cannot read")
"""Why some of these rules are not proved: their words are made up, and have no units."""

ASKED = {
    "together": together,
    **{
        name: ENGINES[name].judge
        for name in (
            "one by one",
            "compiled file",
            "together, in arrays",
            "monitor",
            "path of a graph",
        )
    },
}


@pytest.mark.parametrize("part", range(PARTS))
def test_engines_and_the_checker_agree(part):
    """A case is a trace of a rulebook, judged by all that are asked; tables are proved."""
    chance = random.Random(f"cases {part}")
    tried = proved = 0
    while tried < CASES:
        step_s = chance.choice([Fraction(1), Fraction(1, 2)])
        book = rulebook(chance, step_s)
        every = [
            replace(trace, id=f"{number}.{trace.id}")
            for number in range(EACH)
            for trace in traces(chance, step_s)
        ]
        compiled = compile_here(book, step_s)
        reasons = [one.because for one in proofs_of(to_json(compiled).encode())]
        assert [one for one in reasons if one and not one.startswith(UNREAD)] == []
        proved += reasons.count("")
        oracle = Oracle(book)
        expected = [oracle.judged(trace) for trace in every]
        wrong = [
            (name, trace, answer, should)
            for name, judge in ASKED.items()
            for trace, answer, should in zip(
                every, judge(book, compiled, every), expected, strict=True
            )
            if not is_right(answer, should)
        ]
        assert wrong == []
        tried += len(every)
    assert proved
