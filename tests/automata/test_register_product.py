"""Tables with the past in registers, against those of formulas that are translated as a whole."""

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.alphabet import reads_of
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.tables import minimise
from rulec.automata.worker import clocked_jobs
from rulec.automata.worker.clocked_jobs import machines
from rulec.automata.worker.job_answers import answer_to
from rulec.logic.bounds import in_steps
from rulec.logic.formula import Binary, BinaryOperator, Bound, Unary, UnaryOperator
from rulec.logic.pastification import pastified
from support.asked_compilers import machine_by
from support.builders.rulebooks import P, Q, always, implies
from support.generators.timed_formulas import TIMED_VOCABULARY, formulas_in, in_seconds
from support.oracles.installed_spot import spot_bridge

MEANINGS = ("stutter", "finite")


def job(formula, semantics="stutter"):
    reads = reads_of(formula, TIMED_VOCABULARY)
    return Job("rule", formula, reads, (), semantics, ())


def once(steps, of=P):
    return Unary(UnaryOperator.ONCE, of, Bound(Fraction(0), Fraction(steps), "steps"))


def in_one_piece(asked):
    """The machine by translating the whole formula."""
    return machine_by(replace(asked, remarks=("as text",)), spot_bridge.COMPILER)


@pytest.mark.spot
@given(formula=formulas_in(max_leaves=4), semantics=st.sampled_from(MEANINGS))
def test_both_ways_make_one_table(formula, semantics):
    asked = job(formula, semantics)
    whole, found = in_one_piece(asked), machine_by(asked, spot_bridge.COMPILER)
    assert getattr(found, "machine", found) == getattr(whole, "machine", whole)


@pytest.mark.spot
@given(
    formula=formulas_in(max_leaves=4),
    semantics=st.sampled_from(MEANINGS),
    steps=st.lists(st.fractions(Fraction(1, 4), 3, max_denominator=4), min_size=3, max_size=3),
)
def test_one_question_is_enough_for_all_steps(formula, semantics, steps):
    """If clocks tell it at all, at each step it is what the whole formula makes there."""
    asked, questions = job(in_seconds(formula), semantics), set()

    def ask(jobs):
        questions.update([one for one in jobs if one.clocks is not None])
        return [answer_to(each, spot_bridge.COMPILER) for each in jobs]

    told = [machines([replace(asked, step_s=step)], ask)[0] for step in steps]
    for step, found in zip(steps, told, strict=True):
        whole = in_one_piece(replace(asked, formula=in_steps(asked.formula, step)))
        assert getattr(found, "machine", found) == getattr(whole, "machine", whole)
    # Two, if what is said of the past gets too large
    assert len(questions) <= 1 + (pastified(asked.formula, semantics) is not None)
    if all(isinstance(found, Done) and found.timed for found in told):
        assert len({found.timed.clocked for found in told}) == 1


@pytest.mark.spot
@pytest.mark.parametrize("semantics", MEANINGS)
@pytest.mark.parametrize("steps", [0, 1, 2, 7, 60])
def test_bounds_of_any_length(steps, semantics):
    """Two bounds multiply: the table has a state for each pair of counts that matters."""
    both = Binary(BinaryOperator.AND, once(steps), once(steps, Q))
    asked = job(always(implies(Unary(UnaryOperator.NOT, P), both)), semantics)
    assert machine_by(asked, spot_bridge.COMPILER).machine == in_one_piece(asked).machine


@pytest.mark.spot
def test_the_automaton_is_the_same_for_all_bounds():
    """Only the table grows: what Spot translates does not contain the bound."""
    seen = []

    def rest(*given):
        found = spot_bridge.COMPILER.rest(*given)
        seen.append((given[1], len(found.automaton.edges)))
        return found

    compiler = replace(spot_bridge.COMPILER, rest=rest)
    for steps in (1, 10, 100):
        both = Binary(BinaryOperator.AND, once(steps), once(steps, Q))
        assert isinstance(machine_by(job(always(implies(P, both))), compiler), Done)
    assert len({*seen}) == 1


@pytest.mark.spot
def test_a_wrong_small_table_is_refused():
    asked = job(always(implies(P, once(3, Q))))

    def rest(asked, _, *more):
        return spot_bridge.COMPILER.rest(asked, always(P), *more)

    compiler = replace(spot_bridge.COMPILER, rest=rest)
    assert machine_by(asked, compiler) == Failed("check")


@pytest.mark.spot
def test_too_many_registers_are_no_obstacle(monkeypatch):
    monkeypatch.setattr(clocked_jobs, "MOST_CLOCKS", 1)
    asked = job(always(implies(once(2), once(3, Q))))
    assert machine_by(asked, spot_bridge.COMPILER).machine == in_one_piece(asked).machine


def distinguished(successors, outputs, one, other):
    """Whether some word leads from two states to different outputs, by going through all pairs."""
    seen = {(one, other)}
    for pair in (waiting := [(one, other)]):
        if outputs[pair[0]] != outputs[pair[1]]:
            return True
        for pair_after in zip(*(successors[state] for state in pair), strict=True):
            if pair_after not in seen:
                seen.add(pair_after)
                waiting.append(pair_after)
    return False


@pytest.mark.parametrize("seed", range(40))
def test_a_minimal_table_has_no_equal_states_and_says_the_same(seed):
    chance = Random(seed)
    size, width = chance.randint(1, 25), chance.randint(1, 3)
    rows = range(size)
    successors = [[chance.randrange(size) for _ in range(width)] for _ in rows]
    if seed % 2:  # long chains, as bounds make them
        successors = [[min(row + 1, size - 1), *own[1:]] for row, own in enumerate(successors)]
    outputs = [[chance.random() < 0.2 for _ in range(width)] for _ in rows]
    first = chance.randrange(size)
    small, said = minimise(successors, outputs, first)
    pairs = [(a, b) for a in range(len(small)) for b in range(a)]
    assert all(distinguished(small, said, a, b) for a, b in pairs)
    both = [*successors, *([state + size for state in row] for row in small)]
    assert not distinguished(both, [*outputs, *said], first, size)
