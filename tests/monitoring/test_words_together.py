"""Words that are run together are kept if each of them is by itself."""

from fractions import Fraction

import numpy as np
from hypothesis import given

from rulec.automata.outcome_machine import KEPT
from rulec.monitoring.batch.stacked.words_together import WordsTogether, are_many
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import LetterSets
from support.builders.rulebooks import compile_here
from support.generators.random_rulebooks import rulebook
from support.generators.seeds import seeds


def by_itself(monitor, word):
    return all(word) and monitor.run(word)[1] == KEPT


@given(seeds)
def test_words_together_are_what_each_is(chance):
    compiled = compile_here(rulebook(chance, Fraction(1)), Fraction(1))
    judged = judged_rules(compiled, None, cut=chance.random() < 0.5)
    for _, machine in judged.machines:
        monitor = machine.monitor
        n_classes = monitor.machine.n_classes
        letters = LetterSets(machine.classes.diagram, [])
        together = WordsTogether(monitor, letters)
        # Single classes keep most words from being open; with 0 nothing can be
        choices = [*[1 << n for n in range(n_classes)], (1 << n_classes) - 1, 0, 3, 1, 1]
        for _ in range(3):
            words = [
                [chance.choice(choices) % (1 << n_classes) for _ in range(chance.randint(1, 6))]
                for _ in range(30)
            ]
            numbers = [letters.number_of(classes) for word in words for classes in word]
            bounds = np.cumsum([0, *map(len, words)])
            found = together.are_kept(np.array(numbers, dtype=np.intp), bounds)
            assert found.tolist() == [by_itself(monitor, word) for word in words]


def test_few_long_words_are_run_one_by_one():
    assert are_many(400, 40)
    assert not are_many(40, 400)
