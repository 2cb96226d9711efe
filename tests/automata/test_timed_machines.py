"""Machines of formulas with bounds and numbers, and on finite words."""

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.automata.alphabet import knowledge, propositions_of, reads_of
from rulec.automata.worker.job_answers import agrees, verdict
from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator
from support.generators.timed_formulas import (
    SPEED,
    TIMED_VOCABULARY,
    comparison,
    letter_number,
    timed_formulas,
)
from support.oracles.installed_spot import machine_of, spot, spot_bridge
from support.oracles.past_in_spot import in_spot, is_easy, spot_automaton

in_hoa, translate = spot_bridge.in_hoa, spot_bridge.translate

both_semantics = st.sampled_from(["stutter", "finite"])


def machine_for(formula, semantics):
    reads = reads_of(formula, TIMED_VOCABULARY)
    found = translate(formula, reads, semantics)
    return machine_of(found, reads)


P, Q = Atom("p"), Atom("q")


def bound(low, high):
    return Bound(low, high, "steps")


def later(operator, low, high, formula=P):
    return Unary(operator, formula, bound(low, high))


ALWAYS, EVENTUALLY, ONCE = UnaryOperator.ALWAYS, UnaryOperator.EVENTUALLY, UnaryOperator.ONCE


LONG = [
    Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, P, later(EVENTUALLY, 0, 40, Q))),
    Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, P, later(ALWAYS, 0, 40, Q))),
    Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, P, later(ONCE, 0, 40, Q))),
    Unary(EVENTUALLY, Binary(BinaryOperator.AND, P, later(ALWAYS, 0, 40, Q))),
]


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@pytest.mark.parametrize("formula", LONG)
def test_a_long_bound_takes_as_many_states_as_it_has_steps(formula, semantics):
    """One for each number of steps left, 0 to 39; one for nothing pending; lost, or won."""
    machine = machine_for(formula, semantics)
    assert len(machine.successors) == 40 + 2
    assert agrees(machine, formula, semantics)


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_ranges_that_overlap_ask_for_the_same_instants(semantics):
    """Which of the coming 40 instants must have q: no set but unions of ranges of 25."""
    formula = Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, P, later(ALWAYS, 16, 40, Q)))
    machine = machine_for(formula, semantics)
    assert len(machine.successors) < 1000 < 2**16
    assert agrees(machine, formula, semantics)


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_random_words_tell_machines_apart(semantics):
    """So they are worth being asked: one step more or less shows."""
    for formula, other in [
        (LONG[0], Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, P, later(EVENTUALLY, 0, 41, Q)))),
        (LONG[2], Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, P, later(ONCE, 0, 39, Q)))),
    ]:
        assert not agrees(machine_for(formula, semantics), other, semantics)


@given(timed_formulas, both_semantics)
def test_machines_are_canonical(formula, semantics):
    """The same language by other operators: another automaton, the same machine."""
    twice = Unary(UnaryOperator.NOT, Unary(UnaryOperator.NOT, formula))
    split = Binary(
        BinaryOperator.OR,
        Binary(BinaryOperator.AND, formula, formula),
        Binary(BinaryOperator.AND, formula, Unary(UnaryOperator.NOT, formula)),
    )
    assert machine_for(formula, semantics) == machine_for(twice, semantics)
    assert machine_for(formula, semantics) == machine_for(split, semantics)


@given(timed_formulas, both_semantics)
def test_machines_are_minimal(formula, semantics):
    machine = machine_for(formula, semantics)
    columns = list(zip(*machine.successors, *machine.outputs, strict=True))
    assert len(set(columns)) == len(columns)
    blocks = [tuple(row) for row in machine.outputs]
    for _ in machine.successors:
        blocks = [
            (blocks[s], *(blocks[t] for t in row)) for s, row in enumerate(machine.successors)
        ]
        numbers = {block: n for n, block in enumerate(dict.fromkeys(blocks))}
        blocks = [(numbers[block],) for block in blocks]
    assert len(set(blocks)) == len(blocks)


@given(timed_formulas)
def test_the_automaton_is_the_formula_under_what_is_known(formula):
    """The whole language, not some words of it: against Spot's own way with past and bounds."""
    assume(is_easy(formula))
    reads = reads_of(formula, TIMED_VOCABULARY)
    axioms = in_spot(knowledge(reads, propositions_of(formula)))
    found = translate(formula, reads)
    automaton = spot.automaton(in_hoa(found.automaton, "rule", ()))
    assert spot.are_equivalent(automaton, spot_automaton(formula, f"G{axioms}"))
    assert spot.is_deterministic(automaton)
    assert spot.is_complete(automaton)
    assert automaton.acc().is_parity()[0]
    known = {str(one) for one in propositions_of(formula)}
    assert {ap.ap_name() for ap in automaton.ap()} <= known


@given(timed_formulas)
def test_so_it_is_on_finite_words(formula):
    assume(is_easy(formula))
    reads = reads_of(formula, TIMED_VOCABULARY)
    axioms = in_spot(knowledge(reads, propositions_of(formula)), "alive")
    found = translate(formula, reads, "finite")
    assert found.alive == "alive"
    meant = spot_automaton(formula, f"G{axioms}", alive="alive")
    automaton = spot.automaton(in_hoa(found.automaton, "rule", ()))
    assert spot.are_equivalent(automaton, meant)
    assert spot.is_deterministic(automaton)
    assert spot.is_complete(automaton)


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_a_signal_called_alive_is_no_end_of_the_word(semantics):
    alive = Atom("alive")
    reads = (*reads_of(P, TIMED_VOCABULARY),)
    reads = (type(reads[0])("alive", ()),)
    for formula, verdicts in [
        (Unary(ALWAYS, alive), [True, False, False]),
        (Unary(EVENTUALLY, alive), [True, True, False]),
    ]:
        found = translate(formula, reads, semantics)
        assert found.alive == ("alive (2)" if semantics == "finite" else None)
        machine = machine_of(found, reads)
        assert [verdict(machine, word) for word in ([1, 1], [1, 0], [0, 0])] == verdicts


def test_different_comparisons_with_one_text_stay_different():
    slow, fast = (comparison("speed", relation, 1) for relation in "<>")
    fast = type(fast)(fast.terms, fast.relation, fast.limit, slow.text)
    formula = Unary(ALWAYS, Binary(BinaryOperator.IMPLIES, slow, Unary(UnaryOperator.NEXT, fast)))
    machine = machine_for(formula, "stutter")
    numbers = [letter_number(machine.reads, {SPEED: speed}) for speed in (0, 2, 1, 2)]
    assert [verdict(machine, numbers[:n]) for n in (1, 2, 3, 4)] == [False, True, True, True]
    assert not verdict(machine, numbers[:1] * 2)
