"""Reader of columns with unknown values: the digits that reads may have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact, scale
from rulec.logic import formula as ltl
from rulec.logic.free_names import reads_in
from rulec.logic.kleene import ObjectBinding
from rulec.monitoring.batch.columns.column_numbers import Mask, numbers_between, partial_values
from rulec.monitoring.batch.columns.column_reader import ColumnReader, NotGivenError
from rulec.monitoring.uncertainty.number_regions import NumberRegions
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.trace import Value
from rulec.trace.partial_truth import UNKNOWN as UNKNOWN_TRUTH
from rulec.trace.partial_truth import Truth
from rulec.trace.trace_columns import Array, Key, TraceColumns
from rulec.vocabulary import Declaration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue
from rulec.vocabulary.vocabulary_model import values_of


def meanings_of(read: Read | NumberRead, vocabulary: Vocabulary) -> Sequence[int]:
    """The digits, as bits, that each number of a read stands for.

    A value's number is its place among those declared; the next number stands for unknown. A number
    whose digit lies between two is encoded as ``lowest * read.size + highest``.
    """
    every = (1 << read.size) - 1
    if isinstance(read, Read):
        values = values_of(vocabulary.declarations[read.name])
        return [*(1 << read.digit(value) for value in values), every]
    return [
        every >> low << low & (1 << high + 1) - 1
        for low in range(read.size)
        for high in range(read.size)
    ]


def quantity(read: NumberRead) -> Key:
    """The quantity that a number read consists of, with its variables.

    No name for a sum or count.
    """
    term = scale(read).quantity
    return ("", ()) if term is None else (term.name, term.arguments)


def number_of_value(
    read: Read | NumberRead, value: Value, vocabulary: Vocabulary
) -> tuple[int, int]:
    """The number that stands for unknown, and that of a value."""
    if isinstance(read, NumberRead):
        digit = read.digit(exact(value))  # type: ignore[arg-type]
        return read.size - 1, digit * (read.size + 1)
    return _number_of_word(vocabulary.declarations[read.name], value)


def _number_of_word(declaration: Declaration, value: Value) -> tuple[int, int]:
    values: Sequence[Value] = values_of(declaration)
    return len(values), values.index(value)


class PartialReader(ColumnReader):
    """A reader of the numbers of ``meanings_of``; a declared default may be ``UNKNOWN``."""

    def __init__(self, columns: TraceColumns, vocabulary: Vocabulary) -> None:
        super().__init__(columns, vocabulary)
        self._numbers: dict[object, Numbers] = {}

    def numbers(self, read: Read | NumberRead, bound: ObjectBinding) -> Numbers:
        """The number of a read in each state, or one for all. Raises NotGivenError."""
        about = read if isinstance(read, Read) else scale(read)
        items = tuple([bound[variable] for variable in about.variables])
        key = (read.name if isinstance(read, Read) else read), items
        if key not in self._numbers:
            self._numbers[key] = (
                self._values(read.name, items)
                if isinstance(read, Read)
                else self._between(read, bound)
            )
        return self._numbers[key]

    def _values(self, name: str, items: tuple[str, ...]) -> Numbers:
        n_values = len(values_of(self._vocabulary.declarations[name]))
        if self.is_dark((name, items)):
            return n_values
        values = self.given(name, items)
        if not isinstance(values, np.ndarray):
            return int(values)
        unknown = self.columns.unknown.get((name, items))
        numbers = values.astype(np.intp)
        return numbers if unknown is None else np.where(unknown, n_values, numbers)

    def codes(self, key: Key, regions: Mapping[str, NumberRegions]) -> tuple[Numbers, int] | None:
        """Numbers for the values of a name in each state, and how many numbers there may be.

        For quantities these are regions, or the first and last region; None if a value has none.
        """
        name, declaration = key[0], self._vocabulary.declarations[key[0]]
        if key not in self.columns.values:
            return int(self.is_dark(key)), 2
        if not isinstance(declaration, Quantity):
            return self._values(*key), len(values_of(declaration)) + 1
        if name not in regions:
            return None
        own = regions[name]
        if (key, own) not in self._numbers:
            self._numbers[key, own] = self._regions(key, own)
        return self._numbers[key, own], own.size**2

    def code_of_value(
        self, key: Key, value: Value, regions: Mapping[str, NumberRegions]
    ) -> tuple[int, int]:
        """The number that ``codes`` uses for unknown, and that for a value."""
        declaration = self._vocabulary.declarations[key[0]]
        if isinstance(declaration, Quantity):
            own = regions[key[0]]
            return own.size - 1, own.region(exact(value)) * (own.size + 1)  # type: ignore[arg-type]
        return _number_of_word(declaration, value)

    def _regions(self, key: Key, regions: NumberRegions) -> Numbers:
        low, unknown = self.columns.values[key], self.columns.unknown.get(key)
        floors, upper = np.array(regions.floors), self.columns.upper.get(key)
        first = floors.searchsorted(low, side="right")
        last = first if upper is None else floors.searchsorted(upper, side="right")
        codes = first * regions.size + last
        return codes if unknown is None else np.where(unknown, regions.size - 1, codes)

    def values_at(self, key: Key, places: NDArray[np.intp]) -> list[PartialValue | None]:
        """The values of a name in the states at some places."""
        declaration, columns = self._vocabulary.declarations[key[0]], self.columns
        if key not in columns.values:
            return [declaration.default] * len(places)
        upper, unknown = columns.upper.get(key), columns.unknown.get(key)
        return partial_values(
            columns.values[key][places],
            None if upper is None else upper[places],
            None if unknown is None else unknown[places],
            declaration,
        )

    def is_dark(self, key: Key) -> bool:
        """Whether no state contains a name and its default is unknown."""
        default: object = self._vocabulary.declarations[key[0]].default
        return key not in self.columns.values and default is UNKNOWN

    def _between(self, read: NumberRead, bound: ObjectBinding) -> Numbers:
        bounds = [(factor, *self._bounds(term, bound)) for factor, term in read.terms]
        return numbers_between(scale(read), bounds, self.columns.layout.n_states)

    def _bounds(
        self, term: ltl.Term, bound: ObjectBinding
    ) -> tuple[Array | float, Array | float, Mask | None]:
        """The least and greatest value of a term, and where it is unknown."""
        if isinstance(term, ltl.Count):
            total, undecided = self.count(term, bound)
            high = total
            for inner, where in undecided:
                if np.any(where):
                    self._check_given(term.body, inner)
                    high = high + where
            return total, high, None
        key = term.name, tuple([bound[variable] for variable in term.arguments])
        if self.is_dark(key):
            return 0.0, 0.0, np.True_
        low = self.given(*key)
        return low, self.columns.upper.get(key, low), self.columns.unknown.get(key)

    def _check_given(self, body: ltl.Formula, bound: ObjectBinding) -> None:
        """Raise NotGivenError if a condition may be unknown because a value is missing."""
        for read in reads_in(body):
            if isinstance(read, ltl.Count):
                raise NotGivenError("", ())
            key = read.name, tuple([bound[variable] for variable in read.arguments])
            if not self.is_dark(key):
                self.given(*key)

    def atom(self, name: str, items: tuple[str, ...], expected: str | None) -> Truth:
        """The three-valued truth of an atom in each state."""
        if self.is_dark((name, items)):
            return UNKNOWN_TRUTH
        truth, unknown = (
            super().atom(name, items, expected),
            self.columns.unknown.get((name, items)),
        )
        return truth if unknown is None else truth.unknown_at(unknown)

    def _compared(self, comparison: ltl.Comparison, bound: ObjectBinding) -> Truth:
        unknown: Mask = np.False_
        for _, term in comparison.terms:
            if isinstance(term, ltl.Count):
                continue
            key = term.name, tuple([bound[variable] for variable in term.arguments])
            if self.is_dark(key):
                return UNKNOWN_TRUTH
            if key in self.columns.unknown:
                unknown = unknown | self.columns.unknown[key]
            if key in self.columns.upper:
                unknown = unknown | (self.columns.upper[key] != self.columns.values[key])
        truth = super()._compared(comparison, bound)
        return truth.unknown_at(np.asarray(unknown))
