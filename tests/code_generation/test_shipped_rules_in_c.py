"""All shipped rules in C: every letter and every step, at steps of 1 s and 0.1 s."""

import shutil
from fractions import Fraction

import pytest

import rulec
from rulec.code_generation.compiled_c.c_library import CLibrary
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.proof.monitor_proof import proof_of
from rulec.rulebook.files.search_path import available_rulebooks

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
QUICK = {("esterle2019", 1), ("un-r157", 1)}


def shipped():
    # `schemas` has no rules of its own: others are made of it.
    for book in sorted({*available_rulebooks()} - {"schemas"}):
        for step in (Fraction(1), Fraction(1, 10)):
            quick = (book, step) in QUICK
            yield pytest.param(book, step, marks=[] if quick else pytest.mark.long)


@pytest.mark.parametrize(("book", "step"), list(shipped()))
def test_all_rules_are_proved(book, step):
    layout = monitor_layout(rulec.compile_rulebook(book, step_s=step), {})
    assert max(len(own.cells) for own in layout.rules) * 2 < 4096, "less than 4 kB a rule"
    parts = list(proof_of(CLibrary(layout, optimised=False), 40))
    assert [part.differs for part in parts] == [()] * 7
    assert parts[2].n == sum(
        len(own.rule.machine.successors) * len(own.rule.machine.successors[0])
        for own in layout.rules
    )
