"""Machines of rules with facts: direct evaluation on words of possible letters, none on others.

A letter is possible if some state has it in which all facts hold, whatever the rule does not read.
"""

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from rulec.automata import compiler
from rulec.automata.alphabet import propositions_of
from rulec.automata.bundle.bundle_file import from_json, to_json
from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRulebook
from rulec.automata.compiler_jobs import Failed
from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.diagnostics import RulecError
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    QuantityTerm,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.semantics import holds
from rulec.monitoring.batch.verify import verify
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook, Variable
from rulec.rulebook.rules.implied_signals import with_implied
from rulec.trace import Trace
from rulec.vocabulary import Quantity as DeclaredQuantity
from rulec.vocabulary import Vocabulary
from support.asked_compilers import machine_by
from support.generators.random_formulas import ATOMS, VOCABULARY, formulas, letters, words
from support.oracles.installed_spot import spot, spot_bridge
from support.oracles.past_in_spot import in_spot, spot_automaton

X = Variable("x", "thing")
BOOLEAN = [
    BinaryOperator.AND,
    BinaryOperator.OR,
    BinaryOperator.IMPLIES,
    BinaryOperator.IFF,
    BinaryOperator.XOR,
]
NO = UnaryOperator.NOT
P, Q, RED = Atom("p"), Atom("q"), Atom("light", (), "red")
NEAR, FAR = Atom("place", ("x",), "near"), Atom("place", ("x",), "far")


def facts_over(atoms):
    said = st.recursive(
        st.sampled_from(atoms) | st.builds(Constant, st.booleans()),
        lambda inner: (
            st.builds(Unary, st.just(NO), inner)
            | st.builds(Binary, st.sampled_from(BOOLEAN), inner, inner)
        ),
        max_leaves=4,
    )
    return st.lists(said, max_size=3)


def book_of(formula, axioms, vocabulary=VOCABULARY, semantics="stutter"):
    rule = Rule("r", "hard", (X,), formula)
    known = tuple(Axiom((X,), fact) for fact in axioms)
    return Rulebook("test", vocabulary, (rule,), semantics=semantics, axioms=known)


def answer(book, *, with_texts=False):
    job = compiler._job(book, compiler.lower(book).rules[0], with_texts=with_texts)
    return machine_by(job, spot_bridge.COMPILER)


def compiled(book):
    """The compiled rulebook, written and read again; None if its facts contradict each other."""
    done = answer(book)
    if isinstance(done, Failed):
        assert done.why == "facts"
        return None
    whole = CompiledRulebook(
        "test",
        with_implied(book.vocabulary, [axiom.formula for axiom in book.axioms]),
        (compiler._compiled(book.rules[0], None, done),),
        "",
        "",
        "",
        (),
        "",
        spot_bridge.VERSION,
        book.semantics,
        axioms=tuple(CompiledAxiom(one.variables, one.formula) for one in book.axioms),
    )
    again = from_json(to_json(whole).encode(), "book.json")
    assert again == whole
    return again


WORLDS = [
    {"place": {"car1": place}, "light": light, "p": p, "q": q}
    for place, light, p, q in product(
        ["near", "far", "gone"], ["red", "green"], [True, False], [True, False]
    )
]


def can_be(world, formula, axioms, worlds, letter_of):
    """Is there a state that is the same to the formula, and in which the facts hold?"""
    read = set(propositions_of(formula))
    return any(
        letter_of(other) & read == letter_of(world) & read
        and all(holds(fact, [letter_of(other)]) for fact in axioms)
        for other in worlds
    )


def letter_of(world):
    (letter,) = letters([world])
    return letter


def check(formula, axioms, word, worlds, letter_of, vocabulary, semantics="stutter"):
    book = compiled(book_of(formula, axioms, vocabulary, semantics))
    if book is None:
        assert not any(all(holds(fact, [letter_of(one)]) for fact in axioms) for one in worlds)
        return
    trace = Trace("t", 1, {"car1": "thing"}, tuple(word))
    impossible = [
        number
        for number, world in enumerate(word)
        if not can_be(world, formula, axioms, worlds, letter_of)
    ]
    if impossible:
        with pytest.raises(RulecError) as caught:
            verify(trace, book)
        (found,) = caught.value.diagnostics
        assert found.code == "R0508"
        assert found.message.startswith(f"state {impossible[0]} cannot be: ")
    else:
        kept = holds(formula, [letter_of(world) for world in word], semantics)
        assert bool(verify(trace, book).violations) != kept


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(formulas, facts_over(ATOMS), words)
@example(
    Binary(BinaryOperator.AND, P, FAR),
    [Binary(BinaryOperator.IMPLIES, P, NEAR)],
    [WORLDS[0], {**WORLDS[0], "place": {"car1": "far"}}],
)
@example(  # Only together, by way of what the rule does not read, do they exclude p and q at once.
    Binary(BinaryOperator.UNTIL, P, Q),
    [Binary(BinaryOperator.IMPLIES, P, RED), Binary(BinaryOperator.IMPLIES, Q, Unary(NO, RED))],
    [WORLDS[0]],
)
@example(P, [Q, Unary(NO, Q)], [WORLDS[0]])
@example(P, [Constant(False)], [WORLDS[0]])
@example(Constant(True), [P], [WORLDS[-1]])
def test_verdicts_are_those_of_direct_evaluation(semantics, formula, axioms, word):
    check(formula, axioms, word, WORLDS, letter_of, VOCABULARY, semantics)


SPEED = ((Fraction(1), QuantityTerm("speed")),)
NUMBERS = Vocabulary(
    "numbers", {"thing": VOCABULARY.types["thing"]}, {"speed": DeclaredQuantity("speed", (), "m/s")}
)
COMPARISONS = [
    Comparison(SPEED, relation, Fraction(limit), f"speed {relation} {limit}")
    for relation in ("<", "<=", "=", "!=", ">=", ">")
    for limit in (1, 2)
]
SPEEDS = [{"speed": half / 2} for half in range(6)]


def comparisons_true(world):
    holding = {
        "<": lambda a, b: a < b,
        "<=": lambda a, b: a <= b,
        "=": lambda a, b: a == b,
        "!=": lambda a, b: a != b,
        ">=": lambda a, b: a >= b,
        ">": lambda a, b: a > b,
    }
    return frozenset(one for one in COMPARISONS if holding[one.relation](world["speed"], one.limit))


@given(
    st.recursive(
        st.sampled_from(COMPARISONS),
        lambda inner: (
            st.builds(Unary, st.sampled_from(UnaryOperator), inner)
            | st.builds(Binary, st.sampled_from(BinaryOperator), inner, inner)
        ),
        max_leaves=4,
    ),
    facts_over(COMPARISONS),
    st.lists(st.sampled_from(SPEEDS), min_size=1, max_size=4),
)
@example(COMPARISONS[0], [COMPARISONS[-1]], [{"speed": 0.5}])  # speed < 1, but always > 2
def test_sides_of_a_number_that_facts_exclude(formula, axioms, word):
    check(formula, axioms, word, SPEEDS, comparisons_true, NUMBERS)


@given(formulas, facts_over(ATOMS))
def test_the_automaton_has_the_words_of_the_formula_on_which_the_facts_hold(formula, axioms):
    """The HOA file's language. The formula reads all that the facts do: nothing is projected."""
    for fact in axioms:
        formula = Binary(BinaryOperator.AND, formula, Binary(BinaryOperator.IMPLIES, fact, fact))
    own = set(atoms_of(formula))
    done = answer(book_of(formula, axioms), with_texts=True)
    assume(not isinstance(done, Failed))
    # The values of enumerations that the formula speaks of exclude each other.
    exclusive = "&".join(
        f"!({in_spot(one)} & {in_spot(other)})"
        for one, other in product(own, repeat=2)
        if one.name == other.name and one != other
    )
    whole = [group for group in (PLACES, LIGHTS) if own >= set(group)]
    some = "&".join(f"({'|'.join(map(in_spot, group))})" for group in whole)
    always = " & ".join(filter(None, ["1", exclusive, some, *map(in_spot, axioms)]))
    meant = spot_automaton(formula, f"G({always})")
    assert spot.are_equivalent(spot.automaton(done.hoa), meant)


PLACES = [Atom("place", ("x",), value) for value in ("near", "far", "gone")]
LIGHTS = [Atom("light", (), value) for value in ("red", "green")]


@given(facts_over(ATOMS))
@example([Constant(False), Constant(False)])
def test_every_fact_of_a_contradiction_is_needed(axioms):
    done = answer(book_of(P, axioms))

    def can_hold(chosen):
        return any(all(holds(fact, [letter_of(one)]) for fact in chosen) for one in WORLDS)

    assert isinstance(done, Failed) != can_hold(axioms)
    if isinstance(done, Failed):
        named = [one.formula for one in done.contradiction]
        assert not can_hold(named)
        for number in range(len(named)):
            assert can_hold([*named[:number], *named[number + 1 :]])


@given(formulas, facts_over(ATOMS))
def test_machines_meet_possible_letters_alone_and_are_minimal_for_them(formula, axioms):
    done = answer(book_of(formula, axioms), with_texts=True)
    assume(not isinstance(done, Failed))
    machine = done.machine
    met = set(machine.letters) - {IMPOSSIBLE}
    assert met == set(range(len(machine.successors[0])))
    columns = list(zip(*machine.successors, *machine.outputs, strict=True))
    assert len(set(columns)) == len(columns)
    reached = [0]
    for state in reached:
        reached += [one for one in dict.fromkeys(machine.successors[state]) if one not in reached]
    assert sorted(reached) == list(range(len(machine.successors)))
    # What is said twice, or follows, changes nothing.
    again = answer(book_of(formula, [*axioms, *axioms[:1]]))
    assert again.machine == machine


def test_a_fact_leaves_fewer_states():
    """q is never seen in a state with p, so there is nothing to remember it for."""
    seen_both = Unary(UnaryOperator.EVENTUALLY, Binary(BinaryOperator.AND, P, Q))
    fact = Unary(NO, Binary(BinaryOperator.AND, P, Q))
    assert len(answer(book_of(seen_both, [])).machine.successors) == 2
    machine = answer(book_of(seen_both, [fact])).machine
    assert (machine.successors, machine.rejecting_sink) == (((0,),), 0)
    assert sorted(machine.letters) == [IMPOSSIBLE, 0, 0, 0]
