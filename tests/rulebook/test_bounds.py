"""Bounds as meant: whole steps, times from 0 on, ranges that hold something, one unit of time."""

from fractions import Fraction

import pytest

from rulec.diagnostics import RulecError
from rulec.logic.bounds import operations_of
from rulec.rulebook.loader import parse_rulebook

BOOK = """rulebook example
param delay = 2 s
signal wet
hard rule r {{ require {operator}[{bound}] not wet }}
"""


def parsed(operator, bound):
    book = parse_rulebook(BOOK.format(operator=operator, bound=bound))
    operation = next(operations_of(book.rules[0].formula))
    return operation.bound.low, operation.bound.high, operation.bound.unit


@pytest.mark.parametrize(
    ("operator", "bound", "expected"),
    [
        ("eventually", "<= 2 steps", (0, 2, "steps")),
        ("eventually", "1 steps .. 2 steps", (1, 2, "steps")),
        ("eventually", "2 steps .. 2 steps", (2, 2, "steps")),
        ("eventually", ">= 1.5 s", (Fraction(3, 2), None, "s")),
        ("eventually", "1 s .. delay", (1, 2, "s")),
        ("next", "3 steps", (3, 3, "steps")),
    ],
)
def test_a_bound_is_a_range_in_one_unit(operator, bound, expected):
    assert parsed(operator, bound) == expected


@pytest.mark.parametrize(
    ("operator", "bound", "words"),
    [
        ("eventually", "<= 1.5 steps", "no 1.5 of a step"),
        ("next", "0.5 steps", "no 0.5 of a step"),
        ("eventually", "2 s .. 1 s", ""),
        ("eventually", "1 s .. 2 steps", ""),
        ("next", "<= 2 steps", ""),
        ("eventually", "2 steps", ""),
    ],
)
def test_a_bound_that_makes_no_sense_is_refused(operator, bound, words):
    with pytest.raises(RulecError) as caught:
        parsed(operator, bound)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code.startswith("R03")
    assert words in diagnostic.message
