"""Compiled rulebooks in which one value is odd, their digests made anew: refused, or read."""

import json
from fractions import Fraction

import pytest

from rulec.automata.bundle.bundle_digest import with_digest
from rulec.automata.bundle.bundle_file import from_json, to_json
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
