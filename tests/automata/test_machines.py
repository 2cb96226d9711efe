"""Machines and automata of formulas: their whole language, their form, and which are the same."""

import pytest
from hypothesis import given

from rulec.automata.alphabet import reads_of
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    atoms_of,
)
from support.generators.random_formulas import VOCABULARY, formulas
from support.oracles.installed_spot import machine_of, spot, spot_bridge
from support.oracles.past_in_spot import spot_automaton

in_hoa, translate = spot_bridge.in_hoa, spot_bridge.translate


def machine_for(formula):
    reads = reads_of(formula, VOCABULARY)
    return machine_of(translate(formula, reads), reads)


P = Atom("p")
GFP = Unary(UnaryOperator.ALWAYS, Unary(UnaryOperator.EVENTUALLY, P))


def previously(formula: Formula) -> Formula:
    return Unary(UnaryOperator.PREVIOUSLY, formula)


@given(formulas)
def test_machines_are_minimal(formula):
    """Any two states are told apart by a word, any two letter classes by a state."""
    machine = machine_for(formula)
    columns = list(zip(*machine.successors, *machine.outputs, strict=True))
    assert len(set(columns)) == len(columns)
    n = len(machine.successors)
    apart = {(a, b) for a in range(n) for b in range(n) if machine.outputs[a] != machine.outputs[b]}
    while True:
        more = {
            (a, b)
            for a in range(n)
            for b in range(n)
            if any(
                pair in apart
                for pair in zip(machine.successors[a], machine.successors[b], strict=True)
            )
        } - apart
        if not more:
            break
        apart |= more
    assert apart == {(a, b) for a in range(n) for b in range(n) if a != b}


@given(formulas)
def test_the_automaton_is_the_formula_under_the_vocabularys_knowledge(formula):
    reads = reads_of(formula, VOCABULARY)
    meant = spot_automaton(formula, f"G({EXCLUSIVE})")
    # Read again, it speaks of the same propositions as other automata here.
    automaton = spot.automaton(in_hoa(translate(formula, reads).automaton, "rule", ()))
    # Values that the formula does not mention are nowhere in the automaton: any of them will do.
    unused = [ap for ap in VALUES if ap not in {str(atom) for atom in atoms_of(formula)}]
    any_value = spot.remove_ap()
    for ap in unused:
        any_value.add_ap(f'"{ap}"')
    assert spot.are_equivalent(automaton, any_value.strip(meant))


VALUES = ["near(x)", "far(x)", "gone(x)", "red", "green"]
EXCLUSIVE = """
    ("near(x)" xor "far(x)" xor "gone(x)") & !("near(x)" & "far(x)" & "gone(x)")
    & ("red" xor "green")
"""


@pytest.mark.parametrize("text", ["XXp2 W FGp0", "p1 <-> (Gp3 <-> FG!p0)"])
def test_formulas_that_other_recipes_get_wrong(text):
    """``sbacc`` and ``generic`` gave wrong automata for these two."""
    language = spot.formula(text)
    automaton = spot.translate(language, "parity", "det", "complete")
    assert spot.are_equivalent(automaton, spot.translate(language, "BA", "low"))


def test_dead_and_safe_states():
    safe_or_dead = {
        P: (True, True),
        Unary(UnaryOperator.ALWAYS, P): (False, True),
        Unary(UnaryOperator.EVENTUALLY, P): (True, False),
        GFP: (False, False),
        Constant(True): (True, False),
        Constant(False): (False, True),
    }
    for formula, (accepting_sink, rejecting_sink) in safe_or_dead.items():
        machine = machine_for(formula)
        assert (machine.accepting_sink is not None, machine.rejecting_sink is not None) == (
            accepting_sink,
            rejecting_sink,
        ), formula
        for trap, verdict in ((machine.accepting_sink, True), (machine.rejecting_sink, False)):
            if trap is not None:
                assert set(machine.successors[trap]) == {trap}
                assert set(machine.outputs[trap]) == {verdict}


@given(formulas)
def test_the_automaton_is_deterministic_and_knows_the_formulas_atoms_alone(formula):
    found = translate(formula, reads_of(formula, VOCABULARY))
    automaton = spot.automaton(in_hoa(found.automaton, "rule", ()))
    assert spot.is_deterministic(automaton)
    assert spot.is_complete(automaton)
    assert automaton.acc().is_parity()[0]
    known = {str(atom) for read in reads_of(formula, VOCABULARY) for atom in atoms_about(read)}
    assert {ap.ap_name() for ap in automaton.ap()} <= known


def atoms_about(read):
    return [Atom(read.name, read.variables, value) for value in read.values or (None,)]


@given(formulas, formulas)
def test_machines_of_equivalent_formulas_are_identical(left, right):
    """De Morgan: the same language by another formula, through another automaton."""
    no = UnaryOperator.NOT
    both = Binary(BinaryOperator.AND, left, right)
    either = Unary(no, Binary(BinaryOperator.OR, Unary(no, left), Unary(no, right)))
    assert machine_for(both) == machine_for(either)


LAWS = {
    "once": (
        lambda a, _: Unary(UnaryOperator.ONCE, a),
        lambda a, _: Unary(UnaryOperator.NOT, historically(Unary(UnaryOperator.NOT, a))),
    ),
    "previously": (
        lambda a, _: previously(a),
        lambda a, _: Unary(
            UnaryOperator.NOT,
            Unary(UnaryOperator.WEAK_PREVIOUSLY, Unary(UnaryOperator.NOT, a)),
        ),
    ),
    "since": (
        lambda a, b: Binary(BinaryOperator.SINCE, a, b),
        lambda a, b: Binary(
            BinaryOperator.OR,
            b,
            Binary(BinaryOperator.AND, a, previously(Binary(BinaryOperator.SINCE, a, b))),
        ),
    ),
    "never": (
        lambda a, _: Unary(UnaryOperator.NEVER, a),
        lambda a, _: Unary(UnaryOperator.ALWAYS, Unary(UnaryOperator.NOT, a)),
    ),
    "then": (
        lambda a, b: Binary(BinaryOperator.THEN, a, b),
        lambda a, b: Binary(
            BinaryOperator.AND,
            a,
            Unary(UnaryOperator.NEXT, Binary(BinaryOperator.UNTIL, a, b)),
        ),
    ),
    "next previously": (
        lambda a, _: Unary(UnaryOperator.NEXT, previously(a)),
        lambda a, _: a,
    ),
}


def historically(formula: Formula) -> Formula:
    return Unary(UnaryOperator.HISTORICALLY, formula)


@pytest.mark.parametrize("law", LAWS)
@given(formulas, formulas)
def test_machines_are_identical_by_the_laws_of_the_past(law, left, right):
    """The same language by another formula, with other memories.

    Both sides are asked of everything at once, so that they read the same."""
    one, other = LAWS[law]
    reading = Binary(BinaryOperator.OR, Unary(UnaryOperator.NOT, left), left)
    reading = Binary(BinaryOperator.AND, reading, Binary(BinaryOperator.IMPLIES, right, right))
    assert machine_for(Binary(BinaryOperator.AND, reading, one(left, right))) == machine_for(
        Binary(BinaryOperator.AND, reading, other(left, right))
    )
