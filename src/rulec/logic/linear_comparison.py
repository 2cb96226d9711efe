"""The normal form of linear comparisons: equal numbers have equal terms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from operator import eq, ge, gt, le, lt, ne
from typing import get_args

from rulec.logic.formula import Comparison, Constant, Relation, Term
from rulec.logic.printing import term_text

MIRRORED: Mapping[Relation, Relation] = {
    "<": ">",
    "<=": ">=",
    "=": "=",
    "!=": "!=",
    ">=": "<=",
    ">": "<",
}
"""Relation -> the one with its sides exchanged."""

DENIED: Mapping[Relation, Relation] = {
    "<": ">=",
    "<=": ">",
    "=": "!=",
    "!=": "=",
    ">=": "<",
    ">": "<=",
}
"""Relation -> the one that holds where it does not."""


def comparison(
    coefficients: Mapping[Term, Fraction], relation: Relation, limit: Fraction, text: str
) -> Comparison | Constant:
    """``sum of coefficient * term`` stands in ``relation`` to ``limit``, in normal form.

    A constant if there are no terms. No coefficient may be 0.
    """
    terms = sorted(coefficients.items(), key=lambda pair: term_text(pair[0]))
    if not terms:
        return Constant(stands(Fraction(0), relation, limit))
    _, lead = terms[0]
    return Comparison(
        tuple((coefficient / lead, term) for term, coefficient in terms),
        relation if lead > 0 else MIRRORED[relation],
        limit / lead,
        text,
    )


_RELATIONS: dict[Relation, Callable[[Fraction, Fraction], bool]] = dict(
    zip(get_args(Relation), (lt, le, eq, ne, ge, gt), strict=True)
)


def stands(number: Fraction, relation: Relation, limit: Fraction) -> bool:
    """Whether a number stands in a relation to a limit."""
    return _RELATIONS[relation](number, limit)


def surely_stands(
    low: Fraction, high: Fraction, relation: Relation, limit: Fraction
) -> bool | None:
    """Whether all numbers from ``low`` to ``high`` stand in a relation; None if only some do."""
    within = low <= limit <= high
    if relation in ("=", "!=") and within:
        return relation == "=" if low == high else None
    first, last = stands(low, relation, limit), stands(high, relation, limit)
    return first if first is last else None
