"""The digits that reads may have, from what is known of the values on which they depend."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from math import inf
from typing import Any, TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.logic import formula as ltl
from rulec.logic.kleene import (
    Between,
    Evaluator,
    Unknown,
    alias_of,
    evaluator_of,
    weighted_sum,
)
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    PartialView,
    Subject,
)
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf, PartialValue

Cube: TypeAlias = tuple[int, ...]
"""For each read the bit set of its digits; all combinations of these are possible."""

Letters: TypeAlias = tuple[Cube, ...]
"""The letters that a state may have: those of all the cubes."""


@dataclass(frozen=True, slots=True, eq=False)
class _Count:
    """A prepared count; where it holds, its variable is the same object as ``alias``, if given."""

    count: ltl.Count
    alias: str | None
    evaluate: Evaluator

    def range(self, binding: Mapping[str, str], view: PartialView) -> tuple[Fraction, Fraction]:
        """How many objects surely count, and how many may. Raises MissingValueError."""
        low = unknown = 0
        present, kind, alias = view.objects, self.count.type, self.alias
        inner = dict(binding)
        for item in present if alias is None else {binding[alias]} & present.keys():
            if view.vocabulary.is_subtype(present[item], kind):
                inner[self.count.variable] = item
                truth = self.evaluate(inner, view)
                if isinstance(truth, Unknown):
                    if not unknown and view.given(truth.name, truth.objects) is None:
                        raise MissingValueError(truth.name, truth.objects)
                    unknown += 1
                else:
                    low += truth
        return Fraction(low), Fraction(low + unknown)


_ERROR = 1e-12
"""The relative error of sums of floats is less than this, also relative to the limits."""


@dataclass(frozen=True, slots=True)
class _Sum:
    """A sum of quantities without counts, in floats."""

    factors: tuple[float, ...]
    limits: tuple[float, ...]

    def digits(self, values: Sequence[PartialValue | None]) -> int | None:
        """The digits, as bits, of a sum of values; None if it is too close to a limit to decide."""
        low = high = size = 0.0
        for factor, value in zip(self.factors, values, strict=True):
            if isinstance(value, Interval):
                ends = factor * value.low, factor * value.high
            elif isinstance(value, float):
                ends = factor * value, factor * value
            else:
                return None
            low, high = low + min(ends), high + max(ends)
            size += abs(ends[0]) + abs(ends[1])
        error = _ERROR * (size + abs(self.limits[0]) + abs(self.limits[-1]))
        if error == inf:
            return None
        first, last = (bisect_left(self.limits, end - error) for end in (low, high))
        if first != bisect_right(self.limits, low + error):
            return None
        if last != bisect_right(self.limits, high + error):
            return None
        return _digits_between(first, last)


@dataclass(frozen=True, slots=True, eq=False)
class ReadDigits:
    """A read prepared for many values; digits are bits.

    Reads of one ``kind`` have the same digits for the same objects of their ``variables``.
    ``names`` are those that it depends on; ``subject`` is the value that it consists of, if it is a
    single one.
    """

    read: Read | NumberRead
    kind: object
    names: tuple[str, ...]
    variables: tuple[str, ...]
    subject: Subject | None
    _floors: tuple[float, ...] = ()
    _known: dict[Any, int] = field(default_factory=dict)
    _count: _Count | None = None
    _sum: _Sum | None = None

    @property
    def summands(self) -> tuple[Subject, ...]:
        """The summands, about variables, if the read is a sum of single values."""
        if self._sum is None or not isinstance(self.read, NumberRead):
            return ()
        terms = [term for _, term in self.read.terms if isinstance(term, ltl.QuantityTerm)]
        return tuple([(term.name, term.arguments) for term in terms])

    def of_sum(self, values: Sequence[PartialValue | None]) -> int | None:
        """The digits of a sum of ``summands``; None if exact numbers are needed."""
        return None if self._sum is None else self._sum.digits(values)

    def of_values(self, values: Sequence[PartialValue | None]) -> list[int]:
        """The digits for each value of the ``subject``; none for missing values."""
        if isinstance(self.read, NumberRead):
            return [self._of_number(value, self.read) for value in values]
        known = self._known
        try:
            return [known[value] for value in values]
        except KeyError:
            known.update((value, possible_digits(self.read, value)) for value in set(values))
            return [known[value] for value in values]

    def _of_number(self, value: PartialValue | None, read: NumberRead) -> int:
        if type(value) is float:
            return 1 << bisect_right(self._floors, value)
        if type(value) is Interval and type(value.low) is float and type(value.high) is float:
            low, high = (
                bisect_right(self._floors, value.low),
                bisect_right(self._floors, value.high),
            )
            return _digits_between(low, high)
        return possible_digits(read, value)

    def in_state(self, binding: Mapping[str, str], view: PartialView) -> int:
        """The digits in a state. Raises MissingValueError."""
        if self.subject is None:
            assert isinstance(self.read, NumberRead)
            if self._count is None:
                return _digits_of_sum(self.read, binding, view)
            low, high = self._count.range(binding, view)
            return _digits_between(self.read.digit(low), self.read.digit(high))
        name, variables = self.subject
        items = tuple([binding[variable] for variable in variables])
        digits = possible_digits(self.read, view.given(name, items))
        if not digits:
            raise MissingValueError(name, items)
        return digits


@lru_cache(maxsize=1 << 12)
def read_digits(read: Read | NumberRead) -> ReadDigits:
    """The prepared read."""
    if isinstance(read, Read):
        own = read.name, read.variables
        return ReadDigits(read, (read.name, read.values), (read.name,), read.variables, subject=own)
    known = scale(read)
    number = known.quantity
    subject = None if number is None else (number.name, number.arguments)
    count = sum_ = None
    if number is None and all(isinstance(term, ltl.QuantityTerm) for _, term in read.terms):
        limits = tuple([float(threshold.limit) for threshold in read.thresholds])
        sum_ = _Sum(tuple([float(factor) for factor, _ in read.terms]), limits)
    match read.terms:
        case ((1, ltl.Count(variable, _, body) as counted),):
            # A lookup by the whole formula in each state would be slow.
            count = _Count(counted, alias_of(variable, body), evaluator_of(body))
    return ReadDigits(
        read,
        known,
        known.names,
        known.variables,
        subject=subject,
        _floors=known.floors,
        _count=count,
        _sum=sum_,
    )


def possible_digits(read: Read | NumberRead, value: PartialValue | Fraction | None) -> int:
    """The digits, as bits, that a read may have for a value; none for a missing value."""
    if value is None:
        return 0
    if value is UNKNOWN:
        return (1 << read.size) - 1
    if isinstance(value, OneOf):
        assert isinstance(read, Read)
        return sum({1 << read.digit(digit) for digit in value.values})
    if isinstance(value, Interval):
        assert isinstance(read, NumberRead)
        known = scale(read)
        return _digits_between(known.digit(value.low), known.digit(value.high))
    if isinstance(value, Fraction):
        # A supposed number may not be a float.
        assert isinstance(read, NumberRead)
        return 1 << read.digit(value)
    return 1 << (read if isinstance(read, Read) else scale(read)).digit(value)


def _digits_of_sum(read: NumberRead, binding: Mapping[str, str], view: PartialView) -> int:
    """The digits of a sum; all of them if it contains an unknown count."""
    total = weighted_sum(read.terms, binding, view)
    if not isinstance(total, Unknown):
        return 1 << read.digit(total)
    if isinstance(total, Between):
        return _digits_between(read.digit(total.low), read.digit(total.high))
    if view.given(total.name, total.objects) is None:
        raise MissingValueError(total.name, total.objects)
    return (1 << read.size) - 1


def names_of_read(read: Read | NumberRead) -> tuple[str, ...]:
    """The names that a read depends on."""
    return (read.name,) if isinstance(read, Read) else scale(read).names


def _digits_between(first: int, last: int) -> int:
    return ((1 << (last - first + 1)) - 1) << first
