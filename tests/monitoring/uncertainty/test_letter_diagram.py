"""A diagram of letters has the classes that the table of letters has, however long that is."""

from collections import Counter
from random import Random

import pytest

from rulec.automata.mealy_monitor import Read
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram


def diagram_of(sizes, letters):
    reads = [Read(f"x{n}", (), tuple(f"{n} {k}" for k in range(s))) for n, s in enumerate(sizes)]
    rows = ((0,) * 4,)
    return LetterDiagram(OutcomeMachine(tuple(reads), letters, rows, rows, frozenset({0})))


@pytest.mark.parametrize("seed", range(40))
def test_the_classes_of_a_cube_are_those_of_its_letters(seed):
    random = Random(seed)
    sizes = [random.choice([2, 2, 3, 4]) for _ in range(random.randrange(8))]
    digits = [()]
    for size in sizes:
        digits = [(*before, digit) for digit in range(size) for before in digits]
    # Few classes, most of them in long stretches, as in rules.
    letters = tuple(random.choice([-1, 0, 1, random.randrange(4)]) for _ in digits)
    if seed % 2:
        letters = tuple(letters[: len(letters) // 4 or 1] * 4)[: len(digits)]
        letters += (2,) * (len(digits) - len(letters))
    diagram = diagram_of(sizes, letters)
    assert diagram.n_letters() == Counter(letters)
    for _ in range(30):
        cube = [random.randrange(1, 1 << size) for size in sizes]
        met = {
            letter
            for own, letter in zip(digits, letters, strict=True)
            if all(mask >> digit & 1 for mask, digit in zip(cube, own, strict=True))
        }
        assert diagram.nodes(cube) == sum(1 << letter + 1 for letter in met)
