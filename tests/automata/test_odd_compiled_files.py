"""Compiled rulebooks in which one value is odd, their digests made anew: refused, or read."""

import json
from fractions import Fraction

import pytest

from rulec import compile_rulebook, parse_rulebook
from rulec.automata.bundle.bundle_file import from_json, to_json, with_digest
from rulec.diagnostics import RulecError
from rulec.logic.formula import Bound, Unary, UnaryOperator
from support.builders.rulebooks import Q, always, book, compile_here, implies, near, rule
from support.generators.odd_documents import ODD_VALUES, places_in, with_value

SOON = Unary(UnaryOperator.EVENTUALLY, Q, Bound(Fraction(0), Fraction(2), "s"))


@pytest.fixture(scope="module")
def document():
    rules = compile_here(
        book(rule("r", always(implies(near("x"), SOON)), "x: thing")), step_s=Fraction(1)
    )
    data = json.loads(to_json(rules))
    del data["sha256"]
    return data


MEANINGS = """rulebook m
type car
quantity speed in km/h default 0
quantity gap(c: car) in m default 100
signal near(c: car), late
define near(c: car) = gap(c) < 1 s * speed + speed * speed / (2 * 8 m/s^2)
define late = once[<= 2 s] some c: car (near(c))
hard rule r(c: car) { require always not near(c) }
hard rule s { require always (late implies gap_free) }
hard rule t(c: car) { require always gap(c) / speed >= 1 s }
signal gap_free default false
"""


@pytest.fixture(scope="module")
def with_meanings():
    return compile_rulebook(parse_rulebook(MEANINGS))


def test_meanings_are_kept(with_meanings):
    again = from_json(to_json(with_meanings).encode(), "m.json")
    assert again.vocabulary.meanings == with_meanings.vocabulary.meanings
    assert [*again.vocabulary.meanings] == ["near", "late", "gap(x1) / speed >= 1 s"]
    assert to_json(again) == to_json(with_meanings)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("near", "variables"), []),
        (("near", "variables"), ["c", "d"]),
        (("near", "formula"), "gap(c) < 1 m"),
        (("late", "tree", 0), "eventually"),  # it looks ahead
        (("late", "tree", 1, "terms", 0, 1, "body", "name"), "late"),  # in a circle
        (("near", "tree", "number", 1, 1), ["%", ["0"], ["0"]]),
        (("near", "tree", "number", 1, 0), "0/0"),
        (("near", "tree", "relation"), "=="),
        (("near", "tree", "variables"), []),
    ],
)
def test_meanings_that_are_none_are_refused(place, value, with_meanings):
    data = json.loads(to_json(with_meanings))
    del data["sha256"]
    spoilt = with_value(data, ("vocabulary", "meanings", *place), value)
    with pytest.raises(RulecError) as refused:
        from_json(with_digest(json.dumps(spoilt, indent=1)).encode(), "odd.json")
    assert [problem.code for problem in refused.value.diagnostics] == ["R0404"]


@pytest.mark.parametrize("name", ODD_VALUES)
def test_an_odd_value_anywhere_is_refused_or_read(name, document):
    # One entry of each table is enough.
    places = [
        place
        for place in places_in(document)
        if all(isinstance(key, str) or key < 2 for key in place)
    ]
    assert len(places) > 50
    for place in places:
        text = json.dumps(with_value(document, place, ODD_VALUES[name]), indent=1)
        try:
            to_json(from_json(with_digest(text).encode(), "odd.json"))
        except RulecError as refused:
            assert [problem.code for problem in refused.diagnostics] == ["R0404"]  # noqa: PT017
