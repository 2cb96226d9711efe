"""The normal form of comparisons holds of the same numbers as what was written."""

from fractions import Fraction

import pytest

from rulec.logic.formula import Comparison, Constant, QuantityTerm
from rulec.logic.linear_comparison import comparison, stands

GAP = QuantityTerm("gap")
RELATIONS = ["<", "<=", "=", "!=", ">=", ">"]


@pytest.mark.parametrize("relation", RELATIONS)
@pytest.mark.parametrize("factor", [2, -2])
@pytest.mark.parametrize("gap", [-2, Fraction(-3, 2), 0, Fraction(3, 2), 2])
def test_the_normal_form_holds_where_the_comparison_does(relation, factor, gap):
    normal = comparison({GAP: Fraction(factor)}, relation, Fraction(3), "as written")
    assert isinstance(normal, Comparison)
    assert normal.terms == ((1, GAP),)
    expected = {
        "<": factor * gap < 3,
        "<=": factor * gap <= 3,
        "=": factor * gap == 3,
        "!=": factor * gap != 3,
        ">=": factor * gap >= 3,
        ">": factor * gap > 3,
    }[relation]
    assert stands(Fraction(gap), normal.relation, normal.limit) is expected


@pytest.mark.parametrize(("relation", "value"), [*zip(RELATIONS, [1, 1, 0, 1, 0, 0], strict=True)])
def test_a_comparison_without_terms_is_a_constant(relation, value):
    assert comparison({}, relation, Fraction(3), "0 and 3") == Constant(bool(value))
