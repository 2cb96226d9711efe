"""What may come of words of sets of letters, and of two letters side by side."""

from itertools import product

import pytest
from hypothesis import given

from rulec.automata.mealy_monitor import Read
from rulec.automata.outcome_machine import KEPT, VIOLATED, OutcomeMachine, bits_of
from rulec.monitoring.uncertainty import uncertain_machine
from rulec.monitoring.uncertainty.run_pairs import Prospects
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses, PossibleWord
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine
from rulec.witnesses.letter_functions import letter_of
from support.generators.seeds import seeds

N_CLASSES = 4
READS = tuple(Read(name, ()) for name in ("a", "b", "c"))


def machine(chance, n_states):
    def rows(most):
        return [[chance.randrange(most) for _ in range(N_CLASSES)] for _ in range(n_states)]

    # One combination of the reads' digits is excluded
    letters = tuple([-1] + [chance.randrange(N_CLASSES) for _ in range(7)])
    return OutcomeMachine(READS, letters, rows(n_states), rows(3), frozenset({0}))


def outcomes_from(own, state, word):
    """The outcomes, as bits, of all words of one class of each set."""
    here, found = {state}, 0
    for place, classes in enumerate(word):
        steps = [(one, symbol) for one in here for symbol in bits_of(classes)]
        if place == len(word) - 1:
            found = sum({1 << own.outputs[one][symbol] for one, symbol in steps})
        here = {own.successors[one][symbol] for one, symbol in steps}
    return found


@pytest.mark.parametrize("n_states", [3, 256, 257])
@given(seeds)
def test_tables_say_what_may_come_of_each_state(n_states, chance):
    own = machine(chance, n_states)
    word = [chance.randrange(1, 1 << N_CLASSES) for _ in range(chance.randrange(1, 6))]
    tables = Prospects(own).along(word)
    assert len(tables) == len(word)
    for state in (0, n_states // 2, n_states - 1):
        for place in range(len(word)):
            assert tables[place][state] == outcomes_from(own, state, word[place:])


@given(seeds)
def test_letters_are_side_by_side_that_agree_on_what_is_fixed(chance):
    own = machine(chance, 2)
    n_cubes = chance.randrange(1, 4)
    left, right = (
        tuple([tuple([chance.randrange(1, 4) for _ in READS]) for _ in range(n_cubes)])
        for _ in range(2)
    )
    fixed = tuple([n for n in range(len(READS)) if chance.random() < 0.5])
    found = LetterClasses(own).side_by_side(left, right, fixed)

    def letters(cubes):
        every = {digits for cube in cubes for digits in product(*map(bits_of, cube))}
        classed = {digits: own.letters[letter_of(digits, READS)] for digits in every}
        return {digits: symbol for digits, symbol in classed.items() if symbol >= 0}

    assert {pair for x, y in found for pair in product(bits_of(x), bits_of(y))} == {
        (first, second)
        for one, first in letters(left).items()
        for other, second in letters(right).items()
        if all(one[n] == other[n] for n in fixed)
    }


@given(seeds)
def test_letters_keep_a_rule_in_whatever_order_if_no_word_of_them_is_lost(chance):
    own = machine(chance, 3)
    letters = chance.randrange(1, 1 << N_CLASSES)
    last = letters & chance.randrange(1, 1 << N_CLASSES)
    # Three states are reached by two letters, if at all
    words = [word for n in range(3) for word in product(bits_of(letters), repeat=n)]
    every = [[*(1 << n for n in word), last] for word in words] if last else []
    expected = bool(last) and all(outcomes_from(own, 0, word) == 1 << KEPT for word in every)
    assert UncertainMachine(own).is_surely_kept(letters, last) == expected


def test_reasons_of_long_words_are_forgotten_again_and_found_again(monkeypatch):
    # Violated by the first letter with `a`
    letters = tuple(digits & 1 for digits in range(8))
    own = OutcomeMachine(READS, letters, [[0, 0]], [[KEPT, VIOLATED]], frozenset({0}))
    asked = UncertainMachine(own)
    monkeypatch.setattr(uncertain_machine, "MOST_STRETCHES", 20)

    def reasons(n_known):
        # `a` is unknown last, and `b` each other time before
        states = (*[((1, 3 - n % 2, 1),) for n in range(n_known)], ((3, 1, 1),))
        names = frozenset({"a"}), frozenset({"b"}), frozenset[str]()
        classes = tuple(asked.classes.of(cubes) for cubes in states)
        word = PossibleWord(classes, True, lambda: states, lambda: names)
        return asked.reasons([word], [{}], "abc")

    first = reasons(9)
    assert first.depends_on == ("a",)
    kept = []
    for n_known in (9, 10, 11, 12):
        reasons(n_known)
        kept.append(len(asked._reasons))
    assert kept == [1, 1, 1, 1]
    assert reasons(9) == first
    assert [reasons(n) and len(asked._reasons) for n in (1, 2, 3)] == [2, 3, 1]
