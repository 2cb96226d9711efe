"""Reader of columns: values, numbers and counts as digits of letters.

Truth is that of Kleene's strong three-valued logic, as ``StateView`` has it for one state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.automata.thresholds import exact, scale
from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.free_names import names_in
from rulec.logic.kleene import ObjectBinding
from rulec.trace.trace_columns import Array, TraceColumns
from rulec.vocabulary import Enumeration, Vocabulary

Summand = tuple[Fraction, Array | float]
"""A coefficient, and a column of numbers (floats or whole numbers) or one number for all states."""

_UNIT = 2.0**-52
"""Twice the relative error of one rounding."""

_TINY = 1e-300
"""Far more than what is lost where results are too small to be normal floats."""


def digits_of_sum(
    read: NumberRead,
    summands: Sequence[Summand],
    n_states: int,
    ignored: NDArray[np.bool_] | np.bool_ = np.False_,
) -> NDArray[np.uint8]:
    """For each state how many of the read's thresholds the sum passes; any if it is ignored."""
    total = np.zeros(n_states)
    size = np.zeros(n_states)
    with np.errstate(all="ignore"):
        for coefficient, numbers in summands:
            part = _nearest(coefficient) * np.asarray(numbers, dtype=np.float64)
            total += part
            size += np.abs(part)
        # Each part: its decimal, its coefficient, the product; then the sums, and the limit.
        error = size * ((len(summands) + 4) * _UNIT) + _TINY
        digits = np.zeros(n_states, dtype=np.uint8)
        unclear = ~np.isfinite(total + error)
        for threshold in read.thresholds:
            limit = _nearest(threshold.limit)
            away = total - limit
            digits += away > 0
            unclear |= ~(np.abs(away) > error + abs(limit) * _UNIT)
    # The same few numbers are at a limit again and again
    known: dict[tuple[float, ...], int] = {}
    for state in (unclear & ~ignored).nonzero()[0].tolist():
        own = _numbers_in(summands, state)
        if own not in known:
            known[own] = read.digit(_exactly(summands, own))
        digits[state] = known[own]
    return digits


def digits_of_count(read: NumberRead, counted: Array) -> NDArray[np.uint8]:
    """For each state how many of the read's thresholds the number of objects passes."""
    numbers = range(int(counted.max(initial=0)) + 1)
    return np.array([read.digit(Fraction(n)) for n in numbers], dtype=np.uint8).take(counted)


def _numbers_in(summands: Sequence[Summand], state: int) -> tuple[float, ...]:
    return tuple(
        numbers[state].item() if isinstance(numbers, np.ndarray) else numbers
        for _, numbers in summands
    )


def _exactly(summands: Sequence[Summand], numbers: Sequence[float]) -> Fraction:
    pairs = zip(summands, numbers, strict=True)
    return sum((coefficient * exact(own) for (coefficient, _), own in pairs), Fraction(0))


def _nearest(number: Fraction) -> float:
    """Float nearest to a number; infinity, which decides nothing, on overflow."""
    try:
        return float(number)
    except OverflowError:
        return float("inf")


SIDES = {"<": (0,), "<=": (0, 1), "=": (1,), "!=": (0, 2), ">=": (1, 2), ">": (2,)}
"""The sides of a limit on which comparisons hold: 0 below it, 1 at it, 2 above it."""


Mask = NDArray[np.bool_] | np.bool_


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Truth known to be true, and known to be false, as masks."""

    true: Mask
    false: Mask


UNKNOWN = Truth(np.False_, np.False_)


def known(values: Mask) -> Truth:
    """Truth that is known in every state."""
    return Truth(values, ~values)


def _equivalence(left: Truth, right: Truth) -> Truth:
    return Truth(
        (left.true & right.true) | (left.false & right.false),
        (left.true & right.false) | (left.false & right.true),
    )


KLEENE_COLUMNS: Algebra[Truth] = Algebra(
    proposition=lambda _: UNKNOWN,
    constant=lambda value: known(np.bool_(value)),
    negation=lambda operand: Truth(operand.false, operand.true),
    conjunction=lambda left, right: Truth(left.true & right.true, left.false | right.false),
    disjunction=lambda left, right: Truth(left.true | right.true, left.false & right.false),
    equivalence=_equivalence,
)
"""The operators; what a proposition is depends on the columns."""


class NotGivenError(Exception):
    """A rule needs a value that has neither column nor default."""

    def __init__(self, name: str, objects: tuple[str, ...]) -> None:
        super().__init__(name)
        self.name = name
        self.objects = objects


class ColumnReader:
    """Caching reader of columns for the rules of a vocabulary."""

    def __init__(self, columns: TraceColumns, vocabulary: Vocabulary) -> None:
        self.columns = columns
        self._vocabulary = vocabulary
        self._known: dict[tuple[object, ...], Array] = {}

    def values(self, name: str, items: tuple[str, ...]) -> Array | bool | float | None:
        """Column of a name, or its default; None if there is neither.

        The default of an enumeration is its place among the declared values.
        """
        column = self.columns.values.get((name, items))
        if column is not None:
            return column
        declaration = self._vocabulary.declarations[name]
        default = declaration.default
        if isinstance(declaration, Enumeration):
            return None if default is None else declaration.values.index(default)
        assert not isinstance(default, str), "only an enumeration's default is a value's name"
        return default

    def given(self, name: str, items: tuple[str, ...]) -> Array | bool | float:
        """Column of a name, or its default. Raises NotGivenError."""
        values = self.values(name, items)
        if values is None:
            raise NotGivenError(name, items)
        return values

    def digits(self, read: NumberRead, bound: ObjectBinding) -> Array:
        """Number of thresholds passed in each state. Raises NotGivenError."""
        chosen = {name: bound[name] for name in scale(read).variables}
        key = (read.terms, read.thresholds, *sorted(chosen.items()))
        if key not in self._known:
            self._known[key] = self._digits(read, chosen)
        return self._known[key]

    def _digits(self, read: NumberRead, bound: ObjectBinding) -> Array:
        n_states = self.columns.layout.n_states
        ready = scale(read)
        match read.terms:
            case ((_, ltl.Count() as count),):
                return digits_of_count(read, self._counted(count, bound))
        if ready.quantity is None:
            summands = [(factor, self._summand(term, bound)) for factor, term in read.terms]
            return digits_of_sum(read, summands, n_states)
        items = tuple([bound[argument] for argument in ready.quantity.arguments])
        numbers = self.given(ready.quantity.name, items)
        if not isinstance(numbers, np.ndarray):
            return np.full(n_states, ready.digit(numbers), dtype=np.uint8)
        digits = np.zeros(n_states, dtype=np.uint8)
        for floor in ready.floors:
            digits += numbers >= floor
        return digits

    def _summand(self, term: ltl.Term, bound: ObjectBinding) -> Array | float:
        """Value of a sum's term. Raises NotGivenError."""
        if isinstance(term, ltl.Count):
            return self._counted(term, bound)
        return self.given(term.name, tuple([bound[variable] for variable in term.arguments]))

    def _counted(self, count: ltl.Count, bound: ObjectBinding) -> Array:
        """Value of a count in each state. Raises NotGivenError if not known."""
        total, undecided = self.count(count, bound)
        for inner, where in undecided:
            if np.any(where):
                raise self._missing(count, inner)
        return total

    def count(
        self, count: ltl.Count, bound: ObjectBinding
    ) -> tuple[Array, list[tuple[ObjectBinding, Mask]]]:
        """How many objects count in each state, and where it is not known whether one does."""
        total: Array = np.zeros(self.columns.layout.n_states, dtype=np.int64)
        undecided: list[tuple[ObjectBinding, Mask]] = []
        for name, kind in self.columns.objects.items():
            if self._vocabulary.is_subtype(kind, count.type):
                inner = {**bound, count.variable: name}
                truth = self._truth(count.body, inner)
                there = self._there(name)
                total += truth.true & there
                undecided.append((inner, there & ~(truth.true | truth.false)))
        return total, undecided

    def _missing(self, count: ltl.Count, bound: ObjectBinding) -> NotGivenError:
        for part in ltl.atoms_of(count.body):
            for read in (part,) if isinstance(part, ltl.Atom) else [term for _, term in part.terms]:
                if not isinstance(read, ltl.Count):
                    items = tuple([bound[variable] for variable in read.arguments])
                    if self.values(read.name, items) is None:
                        return NotGivenError(read.name, items)
        return NotGivenError(next(names_in(count)), ())

    def _there(self, name: str) -> Mask:
        if name not in self.columns.present:
            return np.True_
        first, last = self.columns.present[name]
        layout = self.columns.layout
        there = np.zeros(layout.n_states, dtype=bool)
        there[layout.starts[first] : layout.starts[last + 1]] = True
        return there

    def _truth(self, formula: ltl.Formula, bound: ObjectBinding) -> Truth:
        """Three-valued truth of a non-temporal formula in each state."""

        def proposition(part: ltl.Proposition) -> Truth:
            if isinstance(part, ltl.Comparison):
                return self._compared(part, bound)
            items = tuple([bound[variable] for variable in part.arguments])
            return self.atom(part.name, items, part.value)

        def identity(same: ltl.Same) -> Truth:
            return known(np.bool_(bound[same.left] == bound[same.right]))

        return fold(formula, replace(KLEENE_COLUMNS, proposition=proposition, identity=identity))

    def _compared(self, comparison: ltl.Comparison, bound: ObjectBinding) -> Truth:
        try:
            return known(self.compared(comparison, bound))
        except NotGivenError:
            return UNKNOWN

    def compared(self, comparison: ltl.Comparison, bound: ObjectBinding) -> Mask:
        """Truth of a comparison in each state. Raises NotGivenError."""
        at = Threshold(comparison.limit, inclusive=True)
        above = Threshold(comparison.limit, inclusive=False)
        side = self.digits(NumberRead(comparison.terms, (at, above)), bound)
        return np.isin(side, SIDES[comparison.relation])

    def atom(self, name: str, items: tuple[str, ...], expected: str | None) -> Truth:
        """Three-valued truth of an atom in each state."""
        values = self.values(name, items)
        if values is None:
            return UNKNOWN
        declaration = self._vocabulary.declarations[name]
        if isinstance(declaration, Enumeration):
            assert expected is not None, "the rulebook has been checked"
            return known(np.asarray(values == declaration.values.index(expected)))
        return known(np.asarray(values, dtype=bool))
