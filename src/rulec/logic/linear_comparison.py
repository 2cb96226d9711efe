"""Comparisons in the one form in which those of the same numbers have the same terms."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from rulec.logic.formula import Comparison, Constant, Relation, Term
from rulec.logic.printing import term_in_words

_MIRRORED: dict[Relation, Relation] = {
    "<": ">",
    "<=": ">=",
    "=": "=",
    "!=": "!=",
    ">=": "<=",
    ">": "<",
}


def comparison(
    coefficients: Mapping[Term, Fraction], relation: Relation, limit: Fraction, text: str
) -> Comparison | Constant:
    """``sum of coefficient * term`` stands in ``relation`` to ``limit``.

    True or false if there is nothing to sum. No coefficient is 0.
    """
    terms = sorted(coefficients.items(), key=lambda pair: term_in_words(pair[0]))
    if not terms:
        return Constant(stands(Fraction(0), relation, limit))
    _, lead = terms[0]
    return Comparison(
        tuple((coefficient / lead, term) for term, coefficient in terms),
        relation if lead > 0 else _MIRRORED[relation],
        limit / lead,
        text,
    )


def stands(number: Fraction, relation: Relation, limit: Fraction) -> bool:
    """Does a number stand in a relation to a limit?"""
    match relation:
        case "<":
            return number < limit
        case "<=":
            return number <= limit
        case "=":
            return number == limit
        case "!=":
            return number != limit
        case ">=":
            return number >= limit
        case ">":
            return number > limit
