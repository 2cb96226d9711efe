"""Joint letters against all states: reads, diagrams, alphabets and words, pass by pass."""

from itertools import product

from hypothesis import given, settings
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.witnesses.diagrams.decision_diagrams import DecisionDiagrams
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.joint_reads import joint_reads, normal
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.shortest_words import shortest_word
from support.generators.random_reads import (
    ALL_STATES,
    GRID,
    NUMBERS,
    OBJECTS,
    PLAIN_STATES,
    VOCABULARY,
    digit,
    exact_values,
    letter_functions,
    number_reads,
    plain_reads,
    value,
)

groups = st.lists(letter_functions(), min_size=1, max_size=3)


def own_digits(joint, index, joint_digits):
    """The digits of one function's reads."""
    return tuple(view.digits[joint_digits[view.joint]] for view in joint.views[index])


@given(groups)
def test_joint_reads_determine_those_of_each_function(functions):
    joint = joint_reads(functions, VOCABULARY)
    for state in ALL_STATES[::41]:
        joint_digits = [digit(read, state) for read in joint.reads]
        for index, function in enumerate(functions):
            own = own_digits(joint, index, joint_digits)
            assert own == tuple(digit(read, state) for read in function.reads)
            assert function.value(own) == value(function, state)


@given(groups)
def test_each_subject_is_read_once(functions):
    joint = joint_reads(functions, VOCABULARY)
    subjects = [
        normal(read)[0] if hasattr(read, "terms") else (read.name, read.variables)
        for read in joint.reads
    ]
    assert len(set(subjects)) == len(subjects)
    is_number = [hasattr(read, "terms") for read in joint.reads]
    assert is_number == sorted(is_number, reverse=True)


@given(groups)
def test_diagrams_are_the_functions(functions):
    joint = joint_reads(functions, VOCABULARY)
    diagrams = DecisionDiagrams()
    roots = [
        diagrams.of(function, views) for function, views in zip(functions, joint.views, strict=True)
    ]
    tables = []
    for index, (function, root) in enumerate(zip(functions, roots, strict=True)):
        table = []
        for joint_digits in product(*(range(read.size) for read in joint.reads)):
            node = root
            for level, joint_digit in enumerate(joint_digits):
                assert diagrams.level([node]) >= level
                size = joint.reads[level].size
                (node,) = diagrams.restricted([node], level, size)[joint_digit]
            assert diagrams.level([node]) == float("inf")
            assert diagrams.value(node) == function.value(own_digits(joint, index, joint_digits))
            table.append(diagrams.value(node))
        tables.append(table)
    # Canonical: equal functions are the same node, and no others are.
    for first, second in product(range(len(roots)), repeat=2):
        assert (roots[first] == roots[second]) is (tables[first] == tables[second])


def check_alphabet(functions, states, universe):
    alphabet = JointAlphabet(universe, functions)
    met = {tuple(value(function, state) for function in functions) for state in states}
    assert met <= set(alphabet.letters)
    for letter in alphabet.letters:
        state = alphabet.state(letter)
        values = exact_values(state)
        assert tuple(value(function, values) for function in functions) == letter
    return alphabet, met


@given(st.lists(letter_functions(plain_reads), min_size=1, max_size=3))
def test_the_alphabet_is_what_some_state_reads(functions):
    alphabet, met = check_alphabet(functions, PLAIN_STATES, ObjectUniverse(OBJECTS, VOCABULARY))
    assert met == set(alphabet.letters)


@given(st.lists(letter_functions(number_reads), min_size=1, max_size=2))
@settings(max_examples=settings().max_examples // 4)
def test_the_alphabet_misses_no_numbers(functions):
    check_alphabet(functions, NUMBERS, ObjectUniverse(OBJECTS, VOCABULARY))


@given(st.lists(letter_functions(plain_reads), min_size=1, max_size=2))
def test_axioms_hold_in_every_state_of_the_alphabet(functions):
    near = Atom("place", ("o",), "near")
    quiet = Binary(BinaryOperator.IMPLIES, near, Unary(UnaryOperator.NOT, Atom("q", ("o",))))
    universe = ObjectUniverse(OBJECTS, VOCABULARY, (Axiom((Variable("o", "thing"),), quiet),))
    possible = [
        state
        for state in PLAIN_STATES
        if not (state["place", ("x",)] == "near" and state["q", ("x",)])
    ]
    alphabet, met = check_alphabet(functions, possible, universe)
    assert met == set(alphabet.letters)
    for state in map(alphabet.state, alphabet.letters):
        assert not (
            state.value(("place", ("x",)), VOCABULARY) == "near"
            and state.value(("q", ("x",)), VOCABULARY)
        )


@given(letter_functions(plain_reads))
def test_states_have_as_many_defaults_as_can_be(function):
    alphabet = JointAlphabet(ObjectUniverse(OBJECTS, VOCABULARY), [function])

    def others(values):
        return sum(
            values[key] != VOCABULARY.declarations[key[0]].default
            for key in values
            if VOCABULARY.declarations[key[0]].default is not None
        )

    read = {(one.name, one.variables) for one in function.reads}
    for (letter,) in alphabet.letters:
        state = alphabet.state((letter,))
        fewest = min(
            others({key: said for key, said in values.items() if key in read})
            for values in PLAIN_STATES
            if value(function, values) == letter
        )
        assert others(state.values) == fewest


def test_the_grid_is_as_wide_as_the_thresholds():
    assert (min(GRID), max(GRID)) == (-5, 5)


@st.composite
def monitors(draw, n_classes=2):
    n_states = draw(st.integers(1, 4))
    rows = st.lists(st.integers(0, n_states - 1), min_size=n_classes, max_size=n_classes)
    outputs = st.lists(st.booleans(), min_size=n_classes, max_size=n_classes)
    successors = tuple(tuple(draw(rows)) for _ in range(n_states))
    verdicts = tuple(tuple(draw(outputs)) for _ in range(n_states))
    sinks = {
        verdict: next(
            (
                state
                for state in range(n_states)
                if set(successors[state]) == {state} and set(verdicts[state]) == {verdict}
            ),
            None,
        )
        for verdict in (False, True)
    }
    return MealyMonitor((), (0,), successors, verdicts, sinks[False], sinks[True])


def verdict_of(monitor, word):
    state, verdict = 0, False
    for letter in word:
        verdict = monitor.outputs[state][letter]
        state = monitor.successors[state][letter]
    return verdict


@given(
    st.lists(monitors(), min_size=1, max_size=2), st.lists(st.booleans(), min_size=2, max_size=2)
)
def test_no_word_is_shorter(machines, verdicts):
    verdicts = verdicts[: len(machines)]
    letters = list(product(range(2), repeat=len(machines)))
    word = shortest_word(machines, verdicts, letters)

    def fits(candidate):
        return all(
            verdict_of(machine, [letter[index] for letter in candidate]) is verdict
            for index, (machine, verdict) in enumerate(zip(machines, verdicts, strict=True))
        )

    if word is not None:
        assert word
        assert fits(word)
    # A product of 16 states is seen whole by words of 16 letters; short ones are tried here.
    for length in range(1, min(len(word) if word else 5, 5)):
        assert not any(fits(candidate) for candidate in product(letters, repeat=length))


def test_words_come_in_the_order_of_their_letters():
    monitor = MealyMonitor((), (0, 1), ((0, 0),), ((True, True),), None, 0)
    assert shortest_word([monitor], [True], [(1,), (0,)]) == ((1,),)
    assert shortest_word([monitor], [False], [(0,), (1,)]) is None
