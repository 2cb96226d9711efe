"""Reader of traces in arrays: the numbers of a rule's reads, by state or for chosen objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import ThresholdScale
from rulec.logic import formula as ltl
from rulec.logic.fold import fold
from rulec.monitoring.batch.columns.column_numbers import (
    comparison_sides,
    numbers_between,
    truth_between,
)
from rulec.monitoring.batch.stacked.met_values import KLEENE_COLUMNS, UNKNOWN, MetValues
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stacked_read import StackedRead
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.trace.partly_known.partly_known_values import Number, Truth
from rulec.trace.trace_columns import Array, smallest_unsigned
from rulec.vocabulary import Enumeration
from rulec.vocabulary.partial_values import UNKNOWN as UNKNOWN_VALUE
from rulec.vocabulary.partial_values import PartialValue
from rulec.vocabulary.vocabulary_model import values_of

_ANY_NUMBER = Number(np.float64("-inf"), np.float64("inf"))


class Spots(NamedTuple):
    """States of the stack, with the cells of the variables' objects in each.

    ``whole`` means all states, or all cells, in their order; with a ``kind``, the cells of all
    objects of that type.
    """

    states: Indices
    cells: Mapping[str, Indices]
    whole: bool = False
    kind: str | None = None

    def part(self, chosen: Indices | slice) -> Spots:
        """Some of the spots."""
        cells = {variable: own[chosen] for variable, own in self.cells.items()}
        return Spots(self.states[chosen], cells)


class StackReader:
    """A caching reader of the reads' numbers, shared by all rules."""

    def __init__(self, stack: Stack) -> None:
        self.stack = stack
        self._numbers: dict[int, Array | int] = {}
        self._of_kind: dict[tuple[int, str], Array] = {}
        self._in_cells: dict[int, Numbers] = {}
        self._changes: dict[int, Flags | None] = {}
        self._digits: dict[int, int] = {}
        self.met_values = MetValues(stack)
        self._every_state = np.arange(stack.n_states)

    @cached_property
    def _every_cell(self) -> Indices:
        return np.arange(self.stack.starts[-1])

    def numbers(self, read: StackedRead, spots: Spots | None) -> Numbers:
        """The numbers of a read at some spots, or in all states; a single number if all are equal.

        Raises UnencodableError.
        """
        numbers = self._numbers.get(read.key)
        if numbers is None:
            are_few = spots is not None and len(spots.states) < len(self._every_cell)
            if len(read.variables) > 1 or (read.is_composed and are_few):
                assert spots is not None, "it is about objects"
                return self._of(read, spots)
            numbers = self._numbers[read.key] = self._everywhere(read)
        if spots is None or not isinstance(numbers, np.ndarray):
            return numbers
        if spots.kind is None:
            return numbers.take(self.where(read.variables, spots))
        key = read.key, spots.kind
        if key not in self._of_kind:
            own = self.where(read.variables, spots)
            is_every = bool(read.variables) and len(own) == len(numbers)
            self._of_kind[key] = numbers if is_every else numbers.take(own)
        return self._of_kind[key]

    def in_every_cell(self, read: StackedRead) -> Numbers:
        """The numbers of a read of at most one object in all cells. Raises UnencodableError."""
        numbers = self._in_cells.get(read.key)
        if numbers is None:
            numbers = self.numbers(read, None)
            if isinstance(numbers, np.ndarray) and not read.variables:
                numbers = numbers.take(self.stack.state_of)
            self._in_cells[read.key] = numbers
        return numbers

    def changes(self, read: StackedRead) -> Flags | None:
        """The cells where a read's number differs from the cell before; None if there are none.

        The read is of at most one object. Raises UnencodableError.
        """
        if read.key not in self._changes:
            numbers = self.numbers(read, None)
            changes: Flags | None = None
            if isinstance(numbers, np.ndarray):
                changes = np.zeros(len(numbers), dtype=bool)
                np.not_equal(numbers[1:], numbers[:-1], out=changes[1:])
                if not read.variables:
                    changes = changes.take(self.stack.state_of) if changes.any() else None
            self._changes[read.key] = changes
        return self._changes[read.key]

    def digits(self, read: StackedRead) -> int:
        """The digits, as bits, that a read has anywhere; possibly more.

        Raises UnencodableError.
        """
        known = self._digits.get(read.digits_key)
        if known is None:
            known = self._digits[read.digits_key] = self._digits_met(read) or read.every
        return known

    def digits_of(self, reads: Sequence[StackedRead]) -> tuple[int, ...]:
        """The digits of several reads. Raises UnencodableError."""
        known, signals = self._digits, self.met_values.signals
        for read in reads:
            if read.digits_key not in known:
                # Most reads are of fully known signals
                met = signals.get(read.names[0], 0) if read.ready is None else 0
                known[read.digits_key] = (
                    read.of_met.get(met) or self._digits_met(read) or read.every
                )
        return tuple([known[read.digits_key] for read in reads])

    def _digits_met(self, read: StackedRead) -> int:
        if read.count is not None:
            return self._digits_counted(read, read.count)
        name, *others = read.names
        if others:
            return read.every
        ready = read.ready
        if name not in self.stack.arity:
            default = self.stack.default(name)
            if default is UNKNOWN_VALUE:
                return read.every
            return (
                read.meanings[int(default)] if ready is None else 1 << ready.digit(float(default))
            )
        if ready is None:
            return read.of_values(self.met_values.signals.get(name, 0))
        ends = None if ready.quantity is None else self.stack.ends(name)
        if ends is None:
            return read.every
        low, high = map(ready.digit, ends)
        return (1 << high + 1) - (1 << low)

    def _digits_counted(self, read: StackedRead, count: ltl.Count) -> int:
        """The digits of a count: that of zero if nobody can count, else all."""
        met = self.met_values
        key = tuple([met.with_default(name) for name in read.names])
        known = read.of_counts.get(key)
        if known is None:
            assert isinstance(read.read, NumberRead), "it counts"
            is_nobody = not met.truth_anywhere(count.body).possible
            known = 1 << read.read.digit(Fraction(0)) if is_nobody else read.every
            read.of_counts[key] = known
        return known

    def _everywhere(self, read: StackedRead) -> Array | int:
        """The numbers in all states, or in all cells."""
        digits = self.digits(read)
        if digits & (digits - 1) == 0 and read.meanings.count(digits) == 1:
            return read.meanings.index(digits)
        every = Spots(self._every_state, {}, whole=True)
        if read.variables:
            cells = {read.variables[0]: self._every_cell}
            every = Spots(self.stack.state_of, cells, whole=True)
        numbers = self._of(read, every)
        if isinstance(read.read, Read):
            met = self.met_values.signals.get(read.names[0], 0)
            if met & (met - 1):
                return numbers
        if isinstance(numbers, np.ndarray) and len(numbers) and numbers[0] == numbers[-1]:
            return int(numbers[0]) if (numbers == numbers[0]).all() else numbers
        return numbers

    def _of(self, read: StackedRead, spots: Spots) -> Numbers:
        if isinstance(read.read, Read):
            return self._values(read.read, spots)
        if read.count is not None:
            return self._counted(read, read.read, spots)
        assert read.ready is not None, "it is a number"
        return self._between(read.ready, spots)

    def _values(self, read: Read, spots: Spots) -> Numbers:
        n_values = len(values_of(self.stack.vocabulary.declarations[read.name]))
        column = self.stack.column(read.name)
        if column is None:
            default = self.stack.default(read.name)
            return n_values if default is UNKNOWN_VALUE else int(default)
        values = column.values if column.values.dtype != bool else column.values.view(np.uint8)
        if column.unknown is not None:
            values = np.where(column.unknown, np.asarray(n_values, dtype=values.dtype), values)
        return self._at(values, read.variables, spots)

    def _at(self, values: Array, variables: Sequence[str], spots: Spots) -> Array:
        """A column's values at the spots."""
        if spots.whole and (len(variables) == 1 or not spots.cells):
            return values
        return values.take(self.where(variables, spots))

    def where(self, variables: Sequence[str], spots: Spots) -> Indices:
        """Where the values about the objects of some variables are in their columns."""
        if len(variables) < 2:
            return spots.cells[variables[0]] if variables else spots.states
        object_of = self.stack.object_of
        first, second = [object_of[spots.cells[variable]] for variable in variables]
        return self.stack.pairs.places(first, second, spots.states)

    def _between(self, ready: ThresholdScale, spots: Spots) -> Numbers:
        terms = ready.read.terms
        return numbers_between(ready, [(own, self._number(term, spots)) for own, term in terms])

    def _number(self, term: ltl.Term, spots: Spots) -> Number:
        """The values of a quantity at the spots, or everywhere its default."""
        assert isinstance(term, ltl.QuantityTerm), "it counts nothing"
        column = self.stack.column(term.name)
        if column is None:
            default = self.stack.default(term.name)
            if default is UNKNOWN_VALUE:
                return _ANY_NUMBER
            number = np.float64(default)
            return Number(number, number)
        low = self._at(column.values, term.arguments, spots)
        high = low if column.upper is None else self._at(column.upper, term.arguments, spots)
        if column.unknown is None:
            return Number(low, high)
        dark = self._at(column.unknown, term.arguments, spots)
        return Number(np.where(dark, -np.inf, low), np.where(dark, np.inf, high))

    def _counted(self, read: StackedRead, number: NumberRead, spots: Spots) -> Numbers:
        """The numbers of a count everywhere, over all objects or only those that variables name."""
        count, stack = read.count, self.stack
        assert count is not None
        factor = number.terms[0][0]
        least: Array
        most: Array
        if read.counts_itself:
            truth = self.truth(count.body, spots, read.variables[0])
            suits = self._at(stack.of_type(count.type)[stack.object_of], read.variables, spots)
            least = (suits & truth.sure).astype(np.uint8)
            most = (suits & truth.possible).astype(np.uint8)
        else:
            cells = stack.cells_of_type(count.type)
            states = stack.state_of[cells]
            own_spots = Spots(states, {count.variable: cells})
            truth = self.truth(count.body, own_spots, count.variable)
            there = np.ones(len(states), dtype=bool)
            least = np.bincount(states[there & truth.sure], minlength=stack.n_states)
            most = np.bincount(states[there & truth.possible], minlength=stack.n_states)
        n_counts = int(most.max(initial=0)) + 1
        digits = np.array([number.digit(factor * Fraction(n)) for n in range(n_counts)])
        pairs = (digits[:, None] * number.size + digits).astype(smallest_unsigned(number.size**2))
        if n_counts == 1:
            return int(pairs[0, 0])
        numbers: Array = pairs.take(least * least.dtype.type(n_counts) + most)
        return numbers

    def truth(self, formula: ltl.Formula, spots: Spots, about: str = "") -> Truth:
        """The truth of a formula without temporal operators.

        Every variable stands for the same object, called ``about`` here.
        """

        def proposition(part: ltl.Proposition) -> Truth:
            if isinstance(part, ltl.Comparison):
                return self._compared(part, spots, about)
            return self._atom(part, spots, (about,) * len(part.arguments))

        own = replace(KLEENE_COLUMNS, proposition=proposition)
        return fold(formula, own)

    def _compared(self, comparison: ltl.Comparison, spots: Spots, about: str) -> Truth:
        parts = []
        for factor, term in comparison.terms:
            assert isinstance(term, ltl.QuantityTerm), "it counts nothing"
            own = ltl.QuantityTerm(term.name, (about,) * len(term.arguments))
            parts.append((factor, self._number(own, spots)))
        sides = comparison_sides(comparison.terms, comparison.relation, comparison.limit)
        return truth_between(sides, parts)

    def _atom(self, atom: ltl.Atom, spots: Spots, arguments: tuple[str, ...]) -> Truth:
        declaration = self.stack.vocabulary.declarations[atom.name]
        column = self.stack.column(atom.name)
        met = self.met_values.signals.get(atom.name, 0)
        values: Any
        if column is None:
            values, dark = self.stack.default(atom.name), None
            if values is UNKNOWN_VALUE:
                return UNKNOWN
        elif met and not met & (met - 1):
            values, dark = np.intp(met.bit_length() - 1), None
        else:
            values = self._at(column.values, arguments, spots)
            dark = column.unknown
        if isinstance(declaration, Enumeration):
            assert atom.value is not None, "the rulebook has been checked"
            holds = np.asarray(values == declaration.values.index(atom.value))
        else:
            holds = np.asarray(values, dtype=bool)
        truth = Truth.known(holds)
        return truth if dark is None else truth.unknown_at(self._at(dark, arguments, spots))

    def values_at(
        self, name: str, variables: Sequence[str], spots: Spots
    ) -> list[PartialValue | None]:
        """The values of a name in the states at some spots."""
        declaration = self.stack.vocabulary.declarations[name]
        column = self.stack.column(name)
        if column is None:
            return [declaration.default] * len(spots.states)
        return column.at(self.where(variables, spots)).decoded(declaration)
