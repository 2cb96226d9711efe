"""The plainest ways through decision diagrams are those that trying all digits finds."""

from itertools import product
from random import Random

import pytest

from rulec.automata.mealy_monitor import Read
from rulec.witnesses.diagrams.decision_diagrams import DecisionDiagrams
from rulec.witnesses.diagrams.plainest_ways import Choices, WaySearch, digits_chosen
from rulec.witnesses.joint_reads import JointDigits
from rulec.witnesses.letter_functions import LetterFunction

SIZES = (2, 3, 2, 2, 3, 2)
DEFAULTS = (0, 2, None, 1, 0, 0)


def drawn(random, classes):
    """A function of some of the levels, and which these are."""
    levels = sorted(random.sample(range(len(SIZES)), random.randint(0, 3)))
    reads = tuple(Read(f"w{level}", (), ("a", "b", "c")[: SIZES[level]]) for level in levels)
    n_letters = 1
    for level in levels:
        n_letters *= SIZES[level]
    letters = tuple(random.choices(classes, k=n_letters))
    return levels, LetterFunction(reads, letters)


def by_trial(keys, axioms, digits):
    """The fewest digits that are not the default for each classes, and a first such choice."""
    found = {}
    for chosen in product(*digits):
        values = [
            function.value([chosen[level] for level in levels]) for levels, function in axioms
        ]
        if not all(values):
            continue
        classes = tuple(
            function.value([chosen[level] for level in levels]) for levels, function in keys
        )
        cost = sum(
            default is not None and digit != default
            for digit, default in zip(chosen, DEFAULTS, strict=True)
        )
        if classes not in found or cost < found[classes][0]:
            found[classes] = cost, chosen
    return found


@pytest.mark.parametrize("seed", range(60))
def test_ways_are_the_plainest_ones_in_their_order(seed):
    random = Random(seed)
    keys = [drawn(random, range(random.randint(1, 3))) for _ in range(random.randint(1, 3))]
    keys.append(random.choice(keys))
    axioms = [drawn(random, (0, 1, 1, 1)) for _ in range(random.randint(0, 4))]
    diagrams = DecisionDiagrams()
    roots = [
        diagrams.of(function, [JointDigits(level, tuple(range(SIZES[level]))) for level in levels])
        for levels, function in keys + axioms
    ]
    open_axioms = diagrams.open_axioms(roots[len(keys) :])
    expected = by_trial(keys, axioms, [range(size) for size in SIZES])
    if open_axioms is None:
        assert not expected
        return
    search = WaySearch(diagrams, Choices(SIZES, DEFAULTS), id)
    ways = search.ways(tuple(roots[: len(keys)]), open_axioms)
    # What nothing reads is not chosen, and costs nothing where it is as by default.
    assert list(ways) == list(expected)
    for classes, (cost, chosen) in ways.items():
        least, first = expected[classes]
        assert cost == least
        for level, digit in digits_chosen(chosen):
            assert first[level] == digit
