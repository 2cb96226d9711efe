"""The truth of a rule's atoms by state, from the columns of a trace."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.kleene import alias_of
from rulec.logic.linear_comparison import stands
from rulec.monitoring.bindings import Binding
from rulec.monitoring.uncertainty.one_completion import (
    NOTHING_SUPPOSED,
    Supposed,
    number_at,
)
from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import Interval
from rulec.vocabulary.vocabulary_model import default_value

_HAIR = 1e-8
"""Float sums closer to a limit than this share of their terms are computed exactly."""


class _Column(NamedTuple):
    """Values in the states of a stretch, and where they are unknown or missing.

    For numbers with bounds, the values are the lower bounds and ``high`` the upper ones.
    """

    values: NDArray[Any]
    unknown: Flags | None
    unsaid: Flags | None
    high: NDArray[Any] | None

    @property
    def open(self) -> Flags | None:
        """Where the values are unknown or missing."""
        if self.unknown is None or self.unsaid is None:
            return self.unsaid if self.unknown is None else self.unknown
        return self.unknown | self.unsaid


@dataclass(frozen=True, slots=True)
class ColumnTruths:
    """The truth of propositions in the states of a ``binding``.

    ``supposed`` values replace unknown ones and, for names that are ``untold``, missing ones, too.
    Other missing values take their default or least value.
    """

    arrays: TraceArrays
    vocabulary: Vocabulary
    binding: Binding
    supposed: Supposed = NOTHING_SUPPOSED
    untold: frozenset[str] = frozenset()

    @property
    def n_states(self) -> int:
        """The number of states of the binding."""
        return self.binding.last - self.binding.first + 1

    def of(self, proposition: ltl.Proposition) -> Flags:
        """The truth in each state."""
        if isinstance(proposition, ltl.Comparison):
            return self._compared(proposition)
        name, wanted = proposition.name, proposition.value or True
        declared = default_value(self.vocabulary.declarations[name])
        supposed = self.supposed.values.get(name, declared)
        unsaid = supposed if name in self.untold else declared
        column = self._column(name, proposition.arguments)
        if column is None:
            return np.full(self.n_states, unsaid == wanted)
        texts = self.arrays.texts.get(name)
        code: object = wanted
        if texts is not None:
            code = texts.index(str(wanted)) if wanted in texts else len(texts)
        truths: Flags = column.values == code
        if column.unsaid is not None:
            truths = np.where(column.unsaid, unsaid == wanted, truths)
        if column.unknown is not None:
            truths = np.where(column.unknown, supposed == wanted, truths)
        return truths

    def of_counted(self, count: ltl.Count) -> Iterator[tuple[slice, ColumnTruths]]:
        """For each object that may count, its slice of the states and the truths there."""
        own, objects = self.binding, self.arrays.objects
        alias = alias_of(count.variable, count.body)
        candidates = objects if alias is None else (own.objects[alias],)
        places = {item: place for place, item in enumerate(objects)}
        for item in candidates:
            if self.vocabulary.is_subtype(objects[item], count.type):
                begins, ends = self.arrays.spans[places[item]].tolist()
                first, last = max(own.first, begins), min(own.last, ends)
                if first <= last:
                    bound = {**own.objects, count.variable: item}
                    states = slice(first - own.first, last + 1 - own.first)
                    yield states, replace(self, binding=Binding(bound, first, last))

    def counts(self, count: ltl.Count) -> NDArray[np.intp]:
        """How many objects count in each state."""
        counts = np.zeros(self.n_states, dtype=np.intp)
        for states, own in self.of_counted(count):
            counts[states] += own._holds(count.body)
        return counts

    def _holds(self, formula: ltl.Formula) -> Flags:
        """Where a non-temporal formula holds."""
        objects = self.binding.objects
        algebra: Algebra[Flags] = Algebra(
            proposition=self.of,
            constant=partial(np.full, self.n_states),
            identity=lambda same: np.full(self.n_states, objects[same.left] == objects[same.right]),
            negation=np.logical_not,
            conjunction=np.logical_and,
            disjunction=np.logical_or,
            equivalence=np.equal,
        )
        return fold(formula, algebra)

    def says_all(self, name: str, arguments: Sequence[str]) -> bool:
        """Whether each state gives a name for what the variables stand for, even as unknown."""
        cells = self._cells(name, arguments)
        if cells is None:
            return False
        absent = self.arrays.absent.get(name)
        return absent is None or not absent[cells].any()

    def says(self, name: str) -> bool:
        """Whether there are values of a name."""
        return name in self.arrays.world or name in self.arrays.about

    def is_steady(self, name: str, arguments: Sequence[str]) -> bool:
        """Whether a name has the same value in all states."""
        cells = self._cells(name, arguments)
        if cells is None:
            return True
        parts = [*(self._column(name, arguments) or ())]
        parts += [own[name][cells] for own in (self.arrays.absent,) if name in own]
        return all(part is None or bool((part == part[0]).all()) for part in parts)

    def _cells(self, name: str, arguments: Sequence[str]) -> slice | None:
        """The cells of a name's values for what the variables stand for."""
        first, last = self.binding.first, self.binding.last
        if name in self.arrays.world:
            return slice(first, last + 1)
        if name not in self.arrays.about or len(arguments) != 1:
            return None
        number = [*self.arrays.objects].index(self.binding.objects[arguments[0]])
        only = self.arrays.only.get(name)
        if only is not None and not only[number]:
            return None
        begins = int(self.arrays.starts[number] - self.arrays.spans[number, 0])
        return slice(begins + first, begins + last + 1)

    def _column(self, name: str, arguments: Sequence[str]) -> _Column | None:
        cells = self._cells(name, arguments)
        if cells is None:
            return None
        arrays, high = self.arrays, None
        values = (arrays.world if name in arrays.world else arrays.about)[name][cells]
        if name in arrays.bounds and name not in arrays.texts:
            values, high = (bound[cells] for bound in arrays.bounds[name])
        unknown, unsaid = (
            own[name][cells] if name in own else None for own in (arrays.unknown, arrays.absent)
        )
        return _Column(values, unknown, unsaid, high)

    def _compared(self, comparison: ltl.Comparison) -> Flags:
        """Decided by floats, except where rounding, which is far below ``_HAIR``, could matter."""
        relation, limit = comparison.relation, comparison.limit
        total = np.zeros(self.n_states)
        size = np.full(self.n_states, 1 + abs(float(limit)))
        numbers: list[tuple[Fraction, _Counts | _Numbers]] = []
        for factor, term in comparison.terms:
            own = self._numbers(term)
            numbers.append((factor, own))
            share = float(factor) * own.about()
            total += share
            size += np.abs(share)
        apart = total - float(limit)
        less, more = apart < -_HAIR * size, apart > _HAIR * size
        truths: Flags = {"<": less, "<=": less, ">=": more, ">": more}.get(
            relation, np.full(self.n_states, relation == "!=")
        )
        for state in np.flatnonzero(~(less | more)).tolist():
            parts = [factor * own.exactly(state) for factor, own in numbers]
            truths[state] = stands(sum(parts, Fraction(0)), relation, limit)
        return truths

    def _numbers(self, term: ltl.Term) -> _Counts | _Numbers:
        return _Counts(self.counts(term)) if isinstance(term, ltl.Count) else _Numbers(self, term)


@dataclass(frozen=True, slots=True)
class _Counts:
    """Numbers of objects in the states of a stretch."""

    counts: NDArray[np.intp]

    def about(self) -> NDArray[np.float64]:
        """The numbers as floats."""
        return self.counts.astype(float)

    def exactly(self, state: int) -> Fraction:
        """The number in a state."""
        return Fraction(int(self.counts[state]))


class _Numbers:
    """A quantity in the states of a stretch."""

    def __init__(self, truths: ColumnTruths, term: ltl.QuantityTerm) -> None:
        self._column = truths._column(term.name, term.arguments)
        self._end = truths.supposed.ends.get(term.name)
        declared = default_value(truths.vocabulary.declarations[term.name])
        assert not isinstance(declared, str), "it is a quantity"
        self._default = declared
        self._n_states = truths.n_states

    def about(self) -> NDArray[np.float64]:
        """The numbers as floats, with a relative error of a billionth at most."""
        if self._column is None:
            return np.full(self._n_states, float(self._default))
        values, high, is_open = self._column.values, self._column.high, self._column.open
        own = values.astype(float)
        if high is not None and self._end != "low":
            own = high.astype(float) if self._end == "high" else (values + high) / 2
        return own if is_open is None else np.where(is_open, float(self._default), own)

    def exactly(self, state: int) -> Fraction:
        """The exact number that the decimal stands for."""
        if self._column is None:
            return exact(self._default)
        values, high, is_open = self._column.values, self._column.high, self._column.open
        if is_open is not None and is_open[state]:
            return exact(self._default)
        value = values[state].item()
        if high is not None and (most := high[state].item()) != value:
            value = number_at(Interval(value, most), self._end)
        return exact(value)
