"""Renamed formulas mean the same of other objects."""

from fractions import Fraction

from rulec.logic.formula import Atom, Comparison, Constant, Count, QuantityTerm, Same
from rulec.logic.free_names import rename_variables, required_inputs

GAP_V, GAP_W = QuantityTerm("gap", ("v",)), QuantityTerm("gap", ("w",))


def test_the_variable_of_a_count_is_its_own():
    def count(other):
        return Count("v", "car", Same(other, "v"))

    def at_least_one(term):
        return Comparison(((Fraction(1), term),), ">=", Fraction(1))

    assert rename_variables(at_least_one(count("w")), {"v": "a", "w": "b"}) == at_least_one(
        count("b")
    )


def test_terms_are_in_order_again():
    """gap(v) - 2 gap(w) < 3 with the names swapped: gap(w) - 2 gap(v) < 3."""
    before = Comparison(
        ((Fraction(1), GAP_V), (Fraction(-2), GAP_W)), "<", Fraction(3), "gap(v) - 2 * gap(w) < 3 m"
    )
    after = rename_variables(before, {"v": "w", "w": "v"})
    assert after == Comparison(
        ((Fraction(1), GAP_V), (Fraction(-1, 2), GAP_W)), ">", Fraction(-3, 2)
    )
    assert str(after) == "gap(w) - 2 * gap(v) < 3 m"
    assert rename_variables(after, {"v": "w", "w": "v"}) == before


def test_text_of_several_arguments_and_units_by_the_same_name():
    distance = QuantityTerm("distance", ("m", "v"))
    before = Comparison(((Fraction(1), distance),), "<", Fraction(3), "distance(m, v) < 3 m")
    assert str(rename_variables(before, {"m": "a", "v": "b"})) == "distance(a, b) < 3 m"


def test_names_that_are_not_given_stay():
    assert rename_variables(Atom("p", ("x", "y")), {"y": "z"}) == Atom("p", ("x", "z"))


def test_inputs_of_counts_are_asked_of_each_object_that_may_count():
    def at_least_one(variable, kind, body):
        return Comparison(((Fraction(1), Count(variable, kind, body)),), ">=", Fraction(1))

    near = at_least_one("w", "car", Atom("near", ("v", "w", "x")))
    slow = Comparison(((Fraction(1), GAP_V), (Fraction(-1), GAP_W)), "<", Fraction(0))
    objects = {"x": "car", "w": "bus"}
    fits = lambda kind, wanted: wanted in (kind, "any")  # noqa: E731
    assert list(required_inputs(at_least_one("v", "any", near), objects, fits)) == [
        Atom("near", ("x", "x", "x")),
        Atom("near", ("w", "x", "x")),
    ]
    assert list(required_inputs(at_least_one("v", "any", slow), objects, fits)) == [
        QuantityTerm("gap", ("x",)),
        GAP_W,
        GAP_W,
        GAP_W,
    ]
    assert list(required_inputs(slow, objects, fits)) == [GAP_V, GAP_W]


def test_terms_that_become_equal_are_added():
    to, fro = QuantityTerm("d", ("v", "x")), QuantityTerm("d", ("x", "v"))
    itself = QuantityTerm("d", ("v", "v"))
    difference = Comparison(((Fraction(1), to), (Fraction(-1), fro)), "!=", Fraction(1))
    assert rename_variables(difference, {"x": "v"}) == Constant(True)
    weighted = Comparison(((Fraction(1), to), (Fraction(2), fro)), "<", Fraction(6))
    assert rename_variables(weighted, {"x": "v"}) == Comparison(
        ((Fraction(1), itself),), "<", Fraction(2)
    )
