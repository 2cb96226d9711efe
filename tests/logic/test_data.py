"""Formulas as plain data."""

import json
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.codec import DEEPEST, from_data, to_data
from rulec.logic.formula import Atom, Bound, Comparison, Count, Same, Unary, UnaryOperator
from support.generators.timed_formulas import CARS, SUMS, comparison, formulas_in, timed_formulas

P = Atom("p")
PER_HOUR = Fraction(5, 18)


def through_json(formula):
    return from_data(json.loads(json.dumps(to_data(formula))))


@given(timed_formulas | formulas_in("s", PER_HOUR))
def test_read_back_as_it_was(formula):
    again = through_json(formula)
    assert again == formula
    assert to_data(again) == to_data(formula)  # texts too, which take no part in comparison


def test_numbers_are_exact_fractions():
    data = to_data(comparison("speed", ">=", PER_HOUR))
    assert (data["limit"], data["terms"][0][0]) == ("5/18", "1")
    bounded = Unary(UnaryOperator.ONCE, P, Bound(Fraction(1, 3), None, "s"))
    assert to_data(bounded)[2] == {"from": "1/3", "to": None, "unit": "s"}


def test_counts_hold_formulas():
    nested = Count("z", "thing", comparison("count y: car (near(y))", ">", 1))
    formula = Comparison(((Fraction(1), nested),), "=", Fraction(0), "text")
    assert through_json(formula) == formula
    assert through_json(Same("x", "y")) == Same("x", "y")


def compared(**changed):
    return {**to_data(comparison("gap(x) - 2 * speed", "<", 3)), **changed}


BOUND = {"from": "0", "to": "2", "unit": "s"}
HOSTILE = [
    None,
    1,
    "p",
    [],
    {},
    ["not"],
    ["not", True, True],
    ["and", True],
    ["and", True, True, True],
    ["sometimes", True],
    [["not"], True],
    ["not", True, BOUND],
    ["and", True, True, BOUND],
    ["always", True, {**BOUND, "unit": "h"}],
    ["always", True, {**BOUND, "from": 0}],
    ["always", True, {**BOUND, "from": "3"}],
    ["always", True, {**BOUND, "from": "-1"}],
    ["always", True, {**BOUND, "to": "1.5"}],
    ["always", True, {**BOUND, "unit": "steps", "to": "3/2"}],
    ["always", True, {"from": "0", "unit": "s"}],
    ["next", True, BOUND],
    ["next", True, {**BOUND, "from": None, "to": None}],
    ["always", True, BOUND, BOUND],
    {"name": "p", "variables": "x", "value": None},
    {"name": "p", "variables": [1], "value": None},
    {"name": "p", "variables": [], "value": 1},
    {"same": ["x"]},
    {"same": ["x", "y"], "more": 1},
    compared(relation="~"),
    compared(relation=["<"]),
    compared(limit=3),
    compared(limit="1/0"),
    compared(limit="2/4"),
    compared(limit="1e9"),
    compared(limit="nan"),
    compared(limit="9" * 5000),
    compared(limit=" 1"),
    compared(text=None),
    compared(terms={}),
    compared(terms=[["1"]]),
    compared(terms=[["1", {"quantity": "speed"}]]),
    compared(terms=[["1", {"quantity": "speed", "variables": [], "more": 1}]]),
    compared(terms=[["1", {"count": "y", "type": "car"}]]),
    compared(terms=[["1", {"count": "y", "type": "car", "body": None}]]),
]


@pytest.mark.parametrize("data", HOSTILE, ids=repr)
def test_anything_else_is_a_value_error(data):
    with pytest.raises(ValueError, match=r".+"):
        from_data(data)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner),
)


@given(timed_formulas, st.data())
def test_damaged_data_is_a_formula_or_a_value_error(formula, data):
    damaged = to_data(formula)
    inside, inner = None, damaged
    while isinstance(inner, list | dict) and inner and data.draw(st.booleans()):
        keys = list(inner) if isinstance(inner, dict) else range(len(inner))
        inside, key = inner, data.draw(st.sampled_from(keys))
        inner = inner[key]
    if inside is None:
        damaged = data.draw(json_values)
    else:
        inside[key] = data.draw(json_values)
    try:
        again = from_data(damaged)
    except ValueError:
        return
    assert to_data(again) == damaged


@pytest.mark.parametrize("n", [DEEPEST + 1, 100_000])
def test_nothing_is_nested_too_deep(n):
    data = True
    for _ in range(n):
        data = ["not", data]
    with pytest.raises(ValueError, match="too deep"):
        from_data(data)
    assert from_data(["not", True]) is not None


@pytest.mark.parametrize("n", [200, 100_000])
def test_nor_are_counts(n):
    data = True
    for _ in range(n):
        term = {"count": "y", "type": "car", "body": data}
        data = {"terms": [["1", term]], "relation": ">", "limit": "0", "text": ""}
    with pytest.raises(ValueError, match="too deep"):
        from_data(data)
    assert CARS in [term for _, term in SUMS["count y: car (near(y))"]]
