"""Tables of the compilers, proved before they are used; and asked about in other ways where not."""

from dataclasses import replace

import pytest

from rulec.automata.alphabet import reads_of
from rulec.automata.compiler_jobs import CheckError, Compiler, Done, Failed, Job
from rulec.automata.decision_diagrams.diagram_compiler import COMPILER
from rulec.logic.formula import Binary, BinaryOperator, Bound, Unary, UnaryOperator
from rulec.validation import table_proof
from support.asked_compilers import machine_by
from support.builders.rulebooks import P, Q, always, eventually, implies
from support.generators.timed_formulas import TIMED_VOCABULARY


def once(steps):
    return Unary(UnaryOperator.ONCE, P, Bound(0, steps, "steps"))


def job(formula, semantics="stutter"):
    reads = reads_of(formula, TIMED_VOCABULARY)
    return Job("rule", formula, reads, (), semantics, ())


def answer(formula, other, semantics="stutter", **more):
    """The answer of a compiler that takes a formula for another one."""

    def translated(asked):
        found = COMPILER.translate(replace(asked, formula=other))
        return replace(found, **more)

    return machine_by(job(formula, semantics), Compiler("", translated, COMPILER.contradicts))


ALIKE = always(implies(Q, once(3)))
NEARLY = [
    (ALIKE, always(implies(Q, once(4)))),
    (ALIKE, always(implies(once(3), Q))),
    (always(eventually(Binary(BinaryOperator.AND, P, Q))), eventually(implies(P, Q))),
]


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@pytest.mark.parametrize(("formula", "other"), NEARLY)
def test_the_table_of_another_formula_is_refused(formula, other, semantics):
    """Even if the compiler says that it has checked its automaton."""
    assert isinstance(answer(formula, formula, semantics), Done)
    assert answer(formula, other, semantics, is_checked=True) == Failed("check")


@pytest.fixture
def nothing_proved(monkeypatch):
    monkeypatch.setattr(table_proof, "QUICK_WORK", 0)


@pytest.mark.usefixtures("nothing_proved")
def test_what_is_not_proved_is_tried_on_random_words():
    assert isinstance(answer(ALIKE, ALIKE), Done)
    for formula, other in NEARLY:
        assert answer(formula, other) == Failed("check")


@pytest.mark.usefixtures("nothing_proved")
def test_what_is_not_proved_is_compared_by_the_compiler():
    asked = []

    def refuses():
        asked.append("compared")
        raise CheckError

    assert answer(ALIKE, ALIKE, compare=refuses) == Failed("check")
    assert answer(ALIKE, ALIKE, is_checked=True, compare=lambda: asked.append("fine")) == answer(
        ALIKE, ALIKE
    )
    assert asked == ["compared", "fine"]


def test_what_is_proved_takes_no_other_check():
    def compare():
        raise AssertionError

    assert isinstance(answer(ALIKE, ALIKE, compare=compare), Done)
