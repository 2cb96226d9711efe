"""The truth of formulas from columns of values, whatever the columns' places are."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from rulec.logic import formula as ltl
from rulec.logic.fold import fold
from rulec.logic.free_names import number_of, terms_of
from rulec.monitoring.batch.columns.calculated_columns import calculated_truth
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
