"""The truth of formulas from columns of values, whatever the columns' places are."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from rulec.array_types import Floats
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.fold import fold
from rulec.logic.free_names import number_of, terms_of
from rulec.logic.kleene import Interval, surely_compares
from rulec.monitoring.batch.columns.column_numbers import comparison_sides, truth_between
from rulec.trace.partly_known.partly_known_values import (
    EnumeratedChoice,
    NameValues,
    Number,
    Truth,
)
from rulec.trace.partly_known.row_stretches import RowStretches
from rulec.vocabulary import Enumeration, Vocabulary


@dataclass(frozen=True, eq=False)
class ColumnFormulas(ABC):
    """The truth of formulas over ``stretches`` of places, each of which has a state.

    What a name's values are there, how many objects count, and which variables stand for the same
    object, is up to those who know the places.
    """

    vocabulary: Vocabulary
    stretches: RowStretches

    @abstractmethod
    def values(self, name: str, arguments: tuple[str, ...]) -> NameValues:
        """The values of a name for the objects of some variables."""

    @abstractmethod
    def counted(self, count: ltl.Count) -> Number:
        """How many objects count."""

    @abstractmethod
    def identity(self, same: ltl.Same) -> Truth:
        """Where two variables stand for the same object."""

    def of(self, formula: ltl.Formula) -> Truth:
        """The truth of a formula."""
        return fold(formula, self.stretches.algebra(self._proposition, self.identity))

    def _proposition(self, asked: ltl.Proposition) -> Truth:
        if isinstance(asked, ltl.Comparison):
            ready = comparison_sides(asked.terms, asked.relation, asked.limit)
            return truth_between(ready, [(own, self._term(term)) for own, term in asked.terms])
        if isinstance(asked, ltl.Calculated):
            terms = {term: self._term(term) for term in terms_of(number_of(asked))}
            return calculated_truth(asked, terms, self.stretches.n_states)
        values = self.values(asked.name, asked.arguments)
        if isinstance(values, EnumeratedChoice):
            declaration = self.vocabulary.declarations[asked.name]
            assert isinstance(declaration, Enumeration), "its values are choices"
            assert asked.value is not None, "the formula has been checked"
            return values.equals(declaration.values.index(asked.value))
        assert isinstance(values, Truth), "the formula has been checked"
        return values

    def _term(self, term: ltl.Term) -> Number:
        if isinstance(term, ltl.Count):
            return self.counted(term)
        number = self.values(term.name, term.arguments)
        assert isinstance(number, Number), "the formula has been checked"
        return number


_ERROR = 1e-9
"""Relative error, far above that of floats, within which a number is compared as fractions."""


class _Ends(NamedTuple):
    """The least and the greatest values, and the ``size`` that bounds what was rounded."""

    low: Floats
    high: Floats
    size: Floats


def calculated_truth(asked: ltl.Calculated, parts: Mapping[ltl.Term, Number], shape: int) -> Truth:
    """The truth of a comparison in ``shape`` states, from its terms' values in all of them.

    Numbers are those of the floats' decimals: where a rounding could decide, it is done again in
    fractions.
    """
    with np.errstate(all="ignore"):
        ends = _sum(number_of(asked), parts)
        low, high, size = (np.broadcast_to(end, shape) for end in ends)
        unknown = np.isnan(low) | np.isnan(high)
        low, high = np.where(unknown, -np.inf, low), np.where(unknown, np.inf, high)
        close = ~(np.minimum(np.abs(low), np.abs(high)) > size * _ERROR)
    ready = comparison_sides((), asked.relation, Fraction(0))
    least, most = (np.sign(end).astype(np.intp) + 1 for end in (low, high))
    sure, possible = ready.every[least, most], ready.some[least, most]
    # Floats do not tell the difference of two numbers beyond them either
    given = [np.isfinite(end) for part in parts.values() for end in (part.low, part.high)]
    is_given = np.broadcast_to(np.logical_and.reduce(np.broadcast_arrays(*given)).ravel(), shape)
    for place in np.where(unknown, is_given, close).nonzero()[0].tolist():
        own = {term: _at(number, place) for term, number in parts.items()}
        surely = surely_compares(asked, own.__getitem__)
        sure[place], possible[place] = surely is True, surely is not False
    return Truth(sure, possible)


def _at(number: Number, place: int) -> Interval | None:
    low, high = (np.ravel(end) for end in (number.low, number.high))
    ends = [float(end[place if len(end) > 1 else 0]) for end in (low, high)]
    return (exact(ends[0]), exact(ends[1])) if np.isfinite(ends).all() else None


def _sum(number: ltl.NumberSum, parts: Mapping[ltl.Term, Number]) -> _Ends:
    low = high = np.float64(number.constant) + np.zeros(1)
    size = np.abs(low)
    for factor, part in number.parts:
        own = _part(part, parts)
        ends = float(factor) * own.low, float(factor) * own.high
        low, high = low + np.minimum(*ends), high + np.maximum(*ends)
        size = size + abs(float(factor)) * own.size
    return _Ends(low, high, size)


def _part(part: ltl.Term | ltl.Operation, parts: Mapping[ltl.Term, Number]) -> _Ends:
    if not isinstance(part, ltl.Operation):
        own = parts[part]
        low, high = (np.asarray(end, dtype=np.float64) for end in (own.low, own.high))
        return _Ends(low, high, np.maximum(np.abs(low), np.abs(high)))
    left, right = _sum(part.left, parts), _sum(part.right, parts)
    size = left.size * right.size
    if part.operator == "/":
        # By what may be 0, anything may come out
        is_open = (right.low <= 0) & (right.high >= 0)
        size = size / np.minimum(right.low**2, right.high**2)
        low, high = (np.where(is_open, np.nan, 1 / end) for end in (right.high, right.low))
        right = _Ends(low, high, size)
    products = [own * other for own in (left.low, left.high) for other in (right.low, right.high)]
    low, high = np.minimum.reduce(products), np.maximum.reduce(products)
    if part.operator == "*" and part.left == part.right:
        squares = left.low**2, left.high**2
        low = np.where((left.low < 0) & (left.high > 0), 0.0, np.minimum(*squares))
        high = np.maximum(*squares)
    return _Ends(low, high, size)
