"""Examples of states that cannot be, by what they say and the defaults of what the rule reads."""

import pytest

from rulec.diagnostics import RulecError
from rulec.rulebook.loader import parse_rulebook

BOOK = """rulebook r
type car
signal p, q, horn, loud(c: car), fast(c: car) default false
signal wet
quantity gap in m default 5
"""


def states_that_cannot_be(fact, formula, states, variables=""):
    """The texts of those that are reported."""
    text = f"{BOOK}fact {fact}\nhard rule r {variables} {{ require always ({formula}) {states} }}"
    found = ()
    try:
        parse_rulebook(text)
    except RulecError as error:
        found = error.diagnostics
    assert {one.code for one in found} <= {"R0306"}
    places = [one.place for one in found]
    return [one.excerpt[one.column - 1 : one.end_column - 1] for one in places]


def test_a_default_counts_where_the_rule_reads_it():
    fact = "horn or not p"
    # Whether there is a horn is not asked, so nobody says that there is none.
    assert states_that_cannot_be(fact, "p or q", "accept { p }") == []
    assert states_that_cannot_be(fact, "p or horn", "accept { p }") == ["p"]


def test_what_a_fact_makes_follow_need_not_be_said():
    chain = "p implies horn\nfact horn implies q"
    assert states_that_cannot_be(chain, "p or q", "accept { p; p and q; q }") == []
    assert states_that_cannot_be(chain, "p or q", "accept { p and not q }") == ["p and not q"]
    about = 'accept "x" (a: car) { p and loud(a) }'
    assert states_that_cannot_be("loud(c) implies fast(c)", "some c: car (fast(c))", about) == []


def test_what_is_said_counts_though_the_rule_does_not_read_it():
    assert states_that_cannot_be("p implies horn", "p or q", "accept { p and not horn }") == [
        "p and not horn"
    ]
    assert states_that_cannot_be("p implies horn", "p or q", "accept { p and horn }") == []


def test_what_has_no_default_and_is_not_said_is_not_known():
    assert states_that_cannot_be("p implies wet", "p or q", "accept { p }") == []
    assert states_that_cannot_be("p implies not p and wet", "p or q", "accept { p }") == ["p"]


def test_a_default_of_a_number():
    assert states_that_cannot_be("gap > 5 m", "p", "accept { p }") == []
    assert states_that_cannot_be("gap > 5 m", "gap > 4 m", "accept { p }") == ["p"]
    assert states_that_cannot_be("gap > 4 m", "gap > 4 m", "accept { p }") == []


def test_numbers_mean_the_decimals_that_are_written():
    """0.1 as a float is more than a tenth."""
    for unit, number in (("m", "0.1"), ("cm", "10")):
        said = f"accept {{ gap = {number} {unit} }}"
        assert states_that_cannot_be("gap <= 0.1 m", "gap > 0", said) == []
        assert states_that_cannot_be("gap < 0.1 m", "gap > 0", said) == [f"gap = {number} {unit}"]


def test_facts_are_about_all_objects_of_an_example():
    fact = "not loud(c)"
    assert states_that_cannot_be(fact, "p", 'accept "x" (a: car) { p and loud(a) }') == [
        "p and loud(a)"
    ]
    assert states_that_cannot_be(
        fact, "not loud(v)", "reject { loud(v) } accept { not loud(v) }", "(v: car)"
    ) == ["loud(v)"]
    for formula in ("p", "some c: car (loud(c))"):
        counted = "count c: car (loud(c)) <= 1"
        two = 'accept "x" (a: car, b: car) { p and loud(a) and loud(b) }'
        assert states_that_cannot_be(counted, formula, two) == ["p and loud(a) and loud(b)"]
        assert states_that_cannot_be(counted, formula, two.replace(" and loud(b)", "")) == []


def test_every_such_state_is_reported():
    said = "accept { q; p and not q; p } reject { p }"
    assert states_that_cannot_be("q or not p", "q", said) == ["p and not q", "p", "p"]


def test_a_fact_that_grows_too_large_is_a_mistake():
    steps = (f"define d{n} = d{n - 1} or d{n - 1}\n" for n in range(1, 12))
    text = f"{BOOK}define d0 = p or p\n{''.join(steps)}fact d11 and d11 and d11\n"
    with pytest.raises(RulecError) as caught:
        parse_rulebook(f"{text}hard rule r {{ require always p }}")
    (mistake,) = caught.value.diagnostics
    assert mistake.code == "R0323"
    assert mistake.message.startswith("the fact `d11 and d11 and d11` has more than 20,000 parts")
