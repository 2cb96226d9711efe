"""The near side is the side on which traffic drives."""

import pytest

from rulec.logic.formula import Atom
from rulec.rulebook.loader import parse_rulebook

BOOK = """rulebook example
traffic {side}
type thing
signal left_of(thing), right_of(thing)
hard rule r (v: thing) {{ require {relation}(v) }}
"""


@pytest.mark.parametrize(
    ("side", "relation", "absolute"),
    [
        ("left", "near_side_of", "left_of"),
        ("left", "far_side_of", "right_of"),
        ("right", "near_side_of", "right_of"),
        ("right", "far_side_of", "left_of"),
    ],
)
def test_a_relative_side_is_an_absolute_one(side, relation, absolute):
    book = parse_rulebook(BOOK.format(side=side, relation=relation))
    assert book.rules[0].formula == Atom(absolute, ("v",))
