"""Formulas and reads as sets of ways to give subjects values, as in a truth table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.fold import fold
from rulec.logic.kleene import Unknown
from rulec.logic.linear_comparison import stands
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    PartialView,
    Subject,
    candidates,
    subjects_in,
)
from rulec.trace import Value
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.partly_known.temporal_operators import BitInstants

Bits: TypeAlias = int
"""A set of ways to give all subjects values."""

Terms: TypeAlias = Sequence[tuple[Fraction, ltl.Term]]


class TruthTable:
    """The ways to give some words values, and some numbers a joint one of several ``points``.

    ``words`` have for each subject its values, in groups that nothing distinguishes. Whatever else
    is asked for has its value in the ``view``; where it has none, truth is unknown.
    """

    def __init__(
        self,
        words: Mapping[Subject, Sequence[Sequence[Value]]],
        points: Sequence[Mapping[Subject, Fraction]],
        view: PartialView,
    ) -> None:
        self.view = view
        self.all: Bits = 1
        self.words: dict[Subject, dict[Any, Bits]] = {}
        for subject, groups in words.items():
            own = self._given(len(groups))
            self.words[subject] = {
                value: ways for group, ways in zip(groups, own, strict=True) for value in group
            }
        self._points = list(zip(self._given(len(points)), points, strict=True))

    def _given(self, n_choices: int) -> Sequence[Bits]:
        """The ways that take each choice of one more subject, once those so far are repeated."""
        before, size = self.all, self.all.bit_length()
        self.all = (1 << size * n_choices) - 1
        each = self.all // before
        self.words = {
            subject: {value: ways * each for value, ways in own.items()}
            for subject, own in self.words.items()
        }
        return [before << n * size for n in range(n_choices)]

    def truth(self, formula: ltl.Formula, environment: Mapping[str, str]) -> Truth[int]:
        """Where a formula holds for the objects of an environment."""

        def proposition(own: ltl.Proposition) -> Truth[int]:
            if isinstance(own, ltl.Comparison):
                totals, missing = self._totals(own.terms, environment)
                ways = [x for total, x in totals.items() if stands(total, own.relation, own.limit)]
                return Truth.known(sum(ways)).unknown_at(missing)
            subject = own.name, tuple([environment[variable] for variable in own.arguments])
            wanted = own.value or True
            if subject in self.words:
                return Truth.known(self.words[subject].get(wanted, 0))
            value = self.view.value(*subject)
            if isinstance(value, Unknown):
                return Truth(0, self.all)
            return Truth.known(self.all * (value == wanted))

        def identity(same: ltl.Same) -> Truth[int]:
            return Truth.known(self.all * (environment[same.left] == environment[same.right]))

        ways = BitInstants(self.all.bit_length(), "over")
        return fold(formula, ways.algebra(proposition, identity)) & Truth.known(self.all)

    def counted(self, formula: ltl.Formula, environment: Mapping[str, str]) -> Mapping[int, Bits]:
        """Whether an object counts, 1 or 0, with the ways. Raises MissingValueError."""
        truth = self.truth(formula, environment)
        self._require_known(truth.unknown, [formula], environment)
        return {0: self.all ^ truth.sure, 1: truth.sure}

    def digits(self, read: Read | NumberRead, environment: Mapping[str, str]) -> Mapping[int, Bits]:
        """Each digit that a read of some of the subjects has, with its ways.

        Raises MissingValueError if a value is missing, KeyError for a word that is no subject.
        """
        if isinstance(read, Read):
            items = tuple([environment[variable] for variable in read.variables])
            return united((read.digit(x), own) for x, own in self.words[read.name, items].items())
        totals, missing = self._totals(read.terms, environment)
        self._require_known(missing, [term for _, term in read.terms], environment)
        return united((read.digit(total), own) for total, own in totals.items())

    def _totals(
        self, terms: Terms, environment: Mapping[str, str]
    ) -> tuple[Mapping[Fraction, Bits], Bits]:
        """The values of a sum, with their ways, and the ways in which it has none."""
        counts = [(factor, term) for factor, term in terms if isinstance(term, ltl.Count)]
        given = [
            (factor, (term.name, tuple([environment[variable] for variable in term.arguments])))
            for factor, term in terms
            if isinstance(term, ltl.QuantityTerm)
        ]
        free = [own for own in given if own[1] in self._points[0][1]]
        known = Fraction(0)
        for factor, subject in given:
            if subject not in self._points[0][1]:
                number = self.view.number(*subject)
                if isinstance(number, Unknown):
                    return {}, self.all
                known += factor * number
        totals = united(
            (sum([factor * point[subject] for factor, subject in free], known), ways)
            for ways, point in self._points
        )
        missing = 0
        for factor, count in counts:
            for item in candidates(count, self.view):
                truth = self.truth(count.body, {**environment, count.variable: item})
                missing |= truth.unknown
                totals = united(
                    (number, ways & own)
                    for total, ways in totals.items()
                    for number, own in ((total, ~truth.sure), (total + factor, truth.sure))
                )
        return totals, missing

    def _require_known(
        self,
        missing: Bits,
        parts: Iterable[ltl.Formula | ltl.Term],
        environment: Mapping[str, str],
    ) -> None:
        if missing:
            subjects = (x for part in parts for x in subjects_in(part, environment, self.view))
            raise MissingValueError(*next(x for x in subjects if self.view.given(*x) is None))


def united(pairs: Iterable[tuple[Any, Bits]]) -> dict[Any, Bits]:
    """The ways of each key that has any."""
    united: dict[Any, Bits] = {}
    for key, ways in pairs:
        if ways:
            united[key] = united.get(key, 0) | ways
    return united
