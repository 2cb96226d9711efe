"""Bounded duties said of the past: the same words, and nothing that grows with a bound."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.clocks.clocked_machine import TimedMachine
from rulec.automata.compiler_jobs import Job
from rulec.automata.mealy_monitor import Read
from rulec.automata.tables import SizeError
from rulec.logic.bounds import in_steps, operations_of, total_bound
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.past_registers import eliminate_past
from rulec.logic.pastification import pastified
from rulec.logic.printing import formula_text
from rulec.logic.semantics import holds
from support.asked_compilers import machine_by
from support.builders.rulebooks import P, Q, always, implies
from support.generators.timed_formulas import in_seconds, timed_formulas
from support.oracles.installed_spot import spot_bridge

BEGUN = Atom("begun")
LETTERS = [frozenset(own) for own in ((), (P,), (Q,), (P, Q))]
SEMANTICS = ("stutter", "finite")


def steps(low, high):
    return Bound(Fraction(low), None if high is None else Fraction(high), "steps")


def within(high, formula):
    return Unary(UnaryOperator.EVENTUALLY, formula, steps(0, high))


def lasting(high, formula):
    return Unary(UnaryOperator.ALWAYS, formula, steps(0, high))


def not_(formula):
    return Unary(UnaryOperator.NOT, formula)


def until(left, right, high):
    return Binary(BinaryOperator.UNTIL, left, right, steps(0, high))


def then(left, right, low, high):
    return Binary(BinaryOperator.THEN, left, right, steps(low, high))


def never(formula):
    return Unary(UnaryOperator.NEVER, formula)


def from_begin(formula):
    """As a rule is asked of a word whose past has not been seen."""
    return Binary(
        BinaryOperator.WEAK_UNTIL, not_(BEGUN), Binary(BinaryOperator.AND, BEGUN, formula)
    )


SHAPES = {
    "a deadline": lambda k: always(implies(P, within(k, Q))),
    "a lasting duty": lambda k: always(implies(P, lasting(k, Q))),
    "a duty that another one fills": lambda k: always(implies(P, until(Q, not_(P), k))),
    "a sequence": lambda k: never(then(P, Q, k, None)),
    "a quick sequence": lambda k: never(then(P, not_(P), 0, k)),
    "three phases": lambda k: never(then(P, then(Q, not_(Q), k, None), 0, k + 1)),
    "a duty unless": lambda k: never(
        Binary(BinaryOperator.AND, P, not_(Binary(BinaryOperator.AND, Q, within(k, not_(P)))))
    ),
    "two duties": lambda k: always(
        implies(P, Binary(BinaryOperator.AND, within(k, Q), lasting(1, P)))
    ),
    "a release": lambda k: always(
        implies(P, Binary(BinaryOperator.RELEASE, Q, P, steps(max(k - 1, 0), k)))
    ),
    "a deadline at the start": lambda k: within(k, Q),
    "what lasts from the start": lambda k: implies(P, lasting(k, Q)),
    "no quick sequence at the start": lambda k: not_(then(P, not_(P), 0, k)),
}


@pytest.mark.parametrize("semantics", SEMANTICS)
@pytest.mark.parametrize("shape", SHAPES)
def test_bounds_in_seconds_become_those_of_any_step(shape, semantics):
    """Of 2.1 s there are, at steps of 0.7 s, three; at 0.8 and 1 s, two; at 3 s, none."""
    for k in (0, 1, Fraction(21, 10)):
        formula = in_seconds(SHAPES[shape](k))
        past = pastified(formula, semantics)
        for step in map(Fraction, ("0.7", "0.8", "1", "3")):
            ours, theirs = in_steps(past, step), in_steps(formula, step)
            for word in product(LETTERS, repeat=4):
                assert holds(ours, word, semantics) == holds(theirs, word, semantics)


@pytest.mark.parametrize("semantics", SEMANTICS)
@pytest.mark.parametrize("shape", SHAPES)
def test_each_shape_holds_for_the_same_words(shape, semantics):
    same_on_all_words(shape, semantics, range(4), 5)


@pytest.mark.long
@pytest.mark.parametrize("semantics", SEMANTICS)
@pytest.mark.parametrize("shape", SHAPES)
def test_each_shape_holds_for_the_same_longer_words(shape, semantics):
    same_on_all_words(shape, semantics, range(7), 7)


def same_on_all_words(shape, semantics, bounds, longest):
    for k in bounds:
        formula = SHAPES[shape](k)
        past = pastified(formula, semantics)
        assert past is not None
        for size in range(1, longest + 1):
            for word in product(LETTERS, repeat=size):
                assert holds(formula, word, semantics) == holds(past, word, semantics)


@given(timed_formulas, st.lists(st.sets(st.sampled_from("pqr")), min_size=1, max_size=9), st.data())
def test_random_duties_hold_for_the_same_words(demanded, names, data):
    formula = data.draw(st.sampled_from([always(demanded), never(demanded)]))
    if data.draw(st.booleans()):
        formula = from_begin(formula)
    atoms = [atom for atom in dict.fromkeys(atoms_of(formula)) if atom != BEGUN]
    word = [frozenset(atom for n, atom in enumerate(atoms) if "pqr"[n % 3] in own) for own in names]
    begins = data.draw(st.integers(0, len(word)))
    word = [own | ({BEGUN} if n >= begins else set()) for n, own in enumerate(word)]
    for semantics in SEMANTICS:
        past = pastified(formula, semantics)
        if past is not None:
            assert holds(formula, word, semantics) == holds(past, word, semantics)


@pytest.mark.parametrize("shape", SHAPES)
def test_no_step_of_a_bound_is_left_to_spot(shape):
    """Only registers depend on the bound, of which each holds one number of steps."""
    rests = []
    for k in (10, 100, 1000):
        past = eliminate_past(pastified(SHAPES[shape](k), "stutter"))
        assert past.memories == ()
        assert total_bound(past.present) == 0
        rests.append((past.present, len(past.registers)))
    assert rests[0] == rests[1] == rests[2]


@pytest.mark.spot
@pytest.mark.parametrize("semantics", SEMANTICS)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_machine_is_that_of_the_whole_formula(shape, semantics):
    for formula in (SHAPES[shape](4), from_begin(SHAPES[shape](3))):
        reads = tuple(Read(atom.name, ()) for atom in dict.fromkeys(atoms_of(formula)))
        asked = Job("rule", formula, reads, (), semantics, ())
        whole = machine_by(replace(asked, remarks=("as text",)), spot_bridge.COMPILER)
        assert machine_by(asked, spot_bridge.COMPILER).machine == whole.machine


@pytest.mark.spot
def test_duties_whose_registers_have_too_many_states_are_translated_with_their_steps(monkeypatch):
    formula = SHAPES["a duty that another one fills"](3)
    reads = tuple(Read(atom.name, ()) for atom in dict.fromkeys(atoms_of(formula)))
    asked = Job("rule", formula, reads, (), "stutter", ())
    usual = machine_by(asked, spot_bridge.COMPILER)
    tried = []

    def too_large(timed, step_s):
        tried.append(len(timed.bounds))
        if timed.bounds:
            raise SizeError
        return at(timed, step_s)

    at = TimedMachine.at
    monkeypatch.setattr(TimedMachine, "at", too_large)
    assert machine_by(asked, spot_bridge.COMPILER) == usual
    assert tried == [2, 0]


@pytest.mark.parametrize(
    "formula",
    [
        always(implies(P, Q)),
        always(implies(P, Unary(UnaryOperator.EVENTUALLY, Q))),
        always(implies(P, Unary(UnaryOperator.EVENTUALLY, Q, steps(1, 3)))),
        always(Binary(BinaryOperator.OR, within(2, P), within(3, Q))),
        always(implies(P, Unary(UnaryOperator.NEXT, Q))),
        Unary(UnaryOperator.EVENTUALLY, Binary(BinaryOperator.AND, P, within(3, Q))),
        Unary(UnaryOperator.EVENTUALLY, Q, steps(1, 3)),
    ],
)
def test_what_the_past_cannot_say_stays(formula):
    assert pastified(formula, "stutter") is None


def test_it_reads_as_when_the_rule_has_failed():
    text = formula_text(pastified(always(implies(P, within(3, Q))), "stutter"))
    assert text == "always not (not q since[>= 3 steps] (p and not q))"
    finite = pastified(always(implies(P, within(3, Q))), "finite")
    assert not any(x.operator is UnaryOperator.EVENTUALLY for x in operations_of(finite))
    assert any(x.operator is UnaryOperator.WEAK_NEXT for x in operations_of(finite))
