"""Limits are covered by examples close to them, on both sides, where that decides."""

from fractions import Fraction

import pytest

from rulec import compile_rulebook
from rulec.book_tests.example_coverage import coverage
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.book_tests.limit_coverage import grain
from rulec.report.tests.example_text import missing_example, missing_examples
from rulec.rulebook.loader import parse_rulebook

HEAD = "rulebook test\nuse road\n"


def run(rules):
    book = parse_rulebook(HEAD + rules)
    outcome = run_rulebook_examples(book, compile_rulebook(book))
    return book, outcome, coverage(outcome)


def missing(rules):
    """Of each rule the sides of limits that no example is close to."""
    _, _, found = run(rules)
    return [[(one.comparison.text, one.value) for one in rule.missing_limits] for rule in found]


@pytest.mark.parametrize(
    ("limit", "close"), [("50", "1"), ("1.5", "0.1"), ("0.25", "0.01"), ("0", "1"), ("125/9", "1")]
)
def test_close_is_one_of_the_last_digit(limit, close):
    assert grain(Fraction(limit)) == Fraction(close)


@pytest.mark.parametrize(
    ("examples", "untouched"),
    [
        ("accept { speed = 20 km/h } reject { speed = 80 km/h }", [True, False]),
        ("accept { speed = 50 km/h } reject { speed = 80 km/h }", [True]),
        ("accept { speed = 49 km/h } reject { speed = 51 km/h }", []),
        ("accept { speed = 48.9 km/h } reject { speed = 51.1 km/h }", [True, False]),
    ],
)
def test_both_sides_need_an_example(examples, untouched):
    rule = f"hard rule A {{ require never speed > 50 km/h {examples} }}"
    assert missing(rule) == [[("speed > 50 km/h", value) for value in untouched]]


def test_a_side_on_which_nothing_is_decided_is_none():
    # Below zero there is nothing, and where a limit stands within another one, it decides nothing.
    assert missing("hard rule A { require always speed >= 0 km/h }") == [[]]
    (sides,) = missing("hard rule A { require never (speed > 50 km/h or speed > 60 km/h) }")
    assert {text for text, _ in sides} == {"speed > 50 km/h"}


def test_a_limit_below_zero_has_two_sides():
    rule = "hard rule A { require always acceleration >= -3 m/s² }"
    assert missing(rule) == [[("acceleration >= -3 m/s²", value) for value in (True, False)]]


def test_what_is_counted_has_no_limit_that_is_close():
    rule = "hard rule A { require never count v: vehicle (beside(v)) > 2 }"
    assert missing(rule) == [[]]


RULES = """\
hard rule A { require never (icy and crossing and speed > 50 km/h) EXAMPLES-A }
hard rule B(v: vehicle) {
  require always (precedes(v) and speed > 10 km/h implies time_headway(v) >= 1.5 s) EXAMPLES-B
}
hard rule C { require always (wet implies eventually[<= 2 s] speed < 5 km/h) EXAMPLES-C }
hard rule D { require always speed <= limit EXAMPLES-D }
"""


def test_the_examples_that_are_proposed_come_out_and_are_close():
    without = RULES
    for name in "ABCD":
        without = without.replace(f"EXAMPLES-{name}", "")
    book, _, found = run(without)
    assert all(rule.missing_limits for rule in found)
    assert all(rule.n_limits == len(rule.missing_limits) for rule in found)
    text = RULES
    for rule in found:
        proposed = [missing_example(one.example, book.vocabulary) for one in rule.missing_limits]
        text = text.replace(f"EXAMPLES-{rule.rule}", " ".join(proposed))
    _, outcome, again = run(text)
    assert [one.name for one in outcome.outcomes if not one.passed] == []
    assert [rule.missing_limits for rule in again] == [()] * 4
    assert [rule.n_limits for rule in again] == [rule.n_limits for rule in found]
    assert "time_headway(v) = 1.4 s" in text
    assert "time_headway(v) = 1.5 s" in text


SIGNS = """\
hard rule A {
  require always (
    speed <= (limit if limit < 1000 km/h else 50 km/h) or motorway and limit >= 1000 km/h
  )
  EXAMPLES
}
"""


def test_a_number_moved_to_its_limit_keeps_its_relation_to_others():
    book, _, (found,) = run(SIGNS.replace("EXAMPLES", ""))
    texts = {one.comparison.text for one in found.missing_limits}
    # Whether a limit is told is no limit to be close to: 999 km/h stands on no sign.
    assert texts == {"speed <= limit", "speed <= 50 km/h"}
    proposed = missing_examples(found, book.vocabulary)
    assert not any("999" in example or "#" in example for example in proposed)
    _, outcome, (again,) = run(SIGNS.replace("EXAMPLES", "\n".join(proposed)))
    assert [one.number for one in outcome.outcomes if not one.passed] == []
    assert (again.missing_limits, again.missing_edges) == ((), ())
