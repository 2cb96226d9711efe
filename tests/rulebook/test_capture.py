"""What a definition counts is not what is counted where it is used."""

import pytest

from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView
from rulec.rulebook.loader import parse_rulebook

BOOK = """rulebook r type car signal near(c: car) default false
define another_is_near(c: car) = some x: car (x != c and near(x))
define has_company(c: car) = another_is_near(c)
hard rule r { require some x: car (near(x) and USE(x)) }
"""


@pytest.mark.parametrize("use", ["another_is_near", "has_company"])
@pytest.mark.parametrize(("near", "expected"), [("a", False), ("ab", True), ("", False)])
def test_a_counted_variable_keeps_its_object(use, near, expected):
    """Some near car has another one near: that takes two."""
    book = parse_rulebook(BOOK.replace("USE", use))
    state = {"near": dict.fromkeys(near, True)}
    moment = StateView(state, dict.fromkeys("abc", "car"), book.vocabulary)
    assert holds(book.rules[0].formula, {}, moment) is expected
