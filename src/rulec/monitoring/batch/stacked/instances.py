"""The choices of objects in all traces for which a rule may be violated or open.

Most choices need no machine: in every state a few reads already show that the letter has no effect
(is idle, see ``idle_letters``), whatever the other reads are. So pairs of objects are formed only
where both have an effect in the same state.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.columns.column_numbers import Mask
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.trace.plain_arrays import ranges

FEW = 1 << 12
"""With at most so many cells, letters are computed in all of them."""

_MOST_TOGETHER = 1 << 20
"""The most states of pairs that are evaluated at once."""

_NONE = np.empty(0, dtype=np.intp)


class NumbersAt(dict[int, Numbers]):
    """The numbers of a rule's reads at some spots, each computed on first use."""

    def __init__(
        self,
        rule: StackedRule,
        reader: StackReader,
        spots: Spots,
        known: Mapping[int, Numbers] = MappingProxyType({}),
    ) -> None:
        super().__init__(known)
        self._rule, self._reader, self._spots = rule, reader, spots

    def __missing__(self, place: int) -> Numbers:
        return self.setdefault(place, self._reader.numbers(self._rule.reads[place], self._spots))

    def with_others(self, others: Mapping[int, Numbers]) -> NumbersAt:
        """The same numbers, but others of some reads."""
        return NumbersAt(self._rule, self._reader, self._spots, {**self, **others})

    def part(self, spots: Spots, at: Indices) -> NumbersAt:
        """The numbers at some of the spots, given by their places ``at``."""
        # Numbers computed from several values are not recomputed
        known = {
            place: own.take(at) if isinstance(own, np.ndarray) and own.ndim else own
            for place, own in self.items()
        }
        return NumbersAt(self._rule, self._reader, spots, known)


@dataclass(frozen=True, slots=True, eq=False)
class Instances:
    """Choices of objects for a rule's variables, in the order in which verdicts list them.

    ``traces`` are the traces of the choices, and ``objects`` has an array for each variable; each
    choice is judged from its state in ``firsts`` to that in ``lasts``. Objects and states are
    numbered as in the stack. ``letters`` are those of all states, if there are no variables.
    """

    traces: Indices
    objects: tuple[Indices, ...]
    firsts: Indices
    lasts: Indices
    letters: Numbers | None = None

    def part(self, members: Indices) -> Instances:
        """Some of the choices."""
        return Instances(
            self.traces[members],
            tuple(own[members] for own in self.objects),
            self.firsts[members],
            self.lasts[members],
            self.letters,
        )

    def spots(self, rule: StackedRule, stack: Stack) -> tuple[Indices, Spots]:
        """The states of all choices, one choice after the other, with the cells of its objects.

        The first item has where the states of each choice begin, and where the last ones end.
        """
        lengths = self.lasts - self.firsts + 1
        bounds = np.zeros(len(lengths) + 1, dtype=np.intp)
        lengths.cumsum(out=bounds[1:])
        states = np.arange(bounds[-1]) + (self.firsts - bounds[:-1]).repeat(lengths)
        cells = {
            variable: states + (stack.starts[own] - stack.firsts[own]).repeat(lengths)
            for variable, own in zip(rule.variables, self.objects, strict=True)
        }
        return bounds, Spots(states, cells)


_NO_INSTANCES = Instances(_NONE, (), _NONE, _NONE)


def numbers_at(
    rule: StackedRule, reader: StackReader, spots: Spots | None, variables: Sequence[str] = ()
) -> list[Numbers]:
    """The numbers of a rule's reads at some spots, or in all states.

    Reads of variables other than ``variables`` are taken to be anything.
    """
    known = frozenset(variables)
    return [
        read.unknown
        if read.variables and not known.issuperset(read.variables)
        else reader.numbers(read, spots)
        for read in rule.reads
    ]


def doubtful_instances(rule: StackedRule, reader: StackReader) -> Instances:
    """All choices for which the rule may not be kept, and possibly others.

    Some read of the rule has an effect somewhere (see ``_SimpleRules.busy``).
    """
    stack = reader.stack
    for kind in rule.types:
        # For most rules about people, cycles or buses there is no such object
        if not stack.has_type(kind):
            return _NO_INSTANCES
    # Counting is slow, and rarely needed to see that there is no effect
    if rule.counts_everywhere:
        uncounted = [
            read.unknown if read.count or read.variables else reader.numbers(read, None)
            for read in rule.reads
        ]
        if not _are_busy(rule, rule.letters.letters_of(uncounted)).any():
            return _NO_INSTANCES
    if len(rule.variables) == 1 and stack.starts[-1] <= FEW:
        few = _doubtful_of_few(rule, reader)
        return _of_objects((few,), stack) if len(few) else _NO_INSTANCES
    every = rule.letters.letters_of(numbers_at(rule, reader, None))
    busy = _are_busy(rule, every)
    if not busy.any():
        return _NO_INSTANCES
    if not rule.variables:
        traces = (~rule.are_kept_in_any_order(every, stack.begins[:-1])).nonzero()[0]
        firsts, lasts = stack.begins[traces], stack.begins[traces + 1] - 1
        return Instances(traces, (), firsts, lasts, every)
    objects: tuple[Indices, ...]
    if len(rule.variables) == 1:
        objects = (_doubtful_objects(rule, reader, busy),)
    else:
        first, second = (
            _busy_cells(rule, reader, busy, (variable, kind))
            for variable, kind in zip(rule.variables, rule.types, strict=True)
        )
        objects = _pairs(rule, reader, first, second)
    return _of_objects(objects, stack)


def with_all_of(suspects: Flags, doubtful: Instances, rule: StackedRule, stack: Stack) -> Instances:
    """The ``doubtful`` choices, and all choices in the traces that are ``suspects``."""
    own = suspects[stack.trace_of]
    if not rule.variables:
        traces = suspects.nonzero()[0]
        firsts, lasts = stack.begins[traces], stack.begins[traces + 1] - 1
        every = Instances(traces, (), firsts, lasts)
    else:
        chosen = [(stack.of_type(kind) & own).nonzero()[0] for kind in rule.types]
        objects = tuple(chosen) if len(chosen) == 1 else stack.pairs_present(chosen[0], chosen[1])
        every = _of_objects(objects, stack)
    others = doubtful.part((~suspects[doubtful.traces]).nonzero()[0])
    if not len(others.traces):
        return every
    both = zip(others.objects, every.objects, strict=True)
    return Instances(
        np.concatenate([others.traces, every.traces]),
        tuple(np.concatenate(pair) for pair in both),
        np.concatenate([others.firsts, every.firsts]),
        np.concatenate([others.lasts, every.lasts]),
    )


def _of_objects(objects: tuple[Indices, ...], stack: Stack) -> Instances:
    """The choices of these objects, one per variable, while all of them are present."""
    first, *others = objects
    firsts, lasts = stack.firsts[first], stack.lasts[first]
    for own in others:
        firsts = np.maximum(firsts, stack.firsts[own])
        lasts = np.minimum(lasts, stack.lasts[own])
    return Instances(stack.trace_of[first], objects, firsts, lasts)


def _doubtful_of_few(rule: StackedRule, reader: StackReader) -> Indices:
    """The objects for the only variable that letters alone do not show to be kept.

    Letters are computed in all cells, since there are few.
    """
    stack, (kind,) = reader.stack, rule.types
    numbers = [
        read.unknown if read.is_composed else reader.in_every_cell(read) for read in rule.reads
    ]
    begins = stack.are_first.nonzero()[0]
    objects = stack.object_of[begins]
    are_kept = rule.are_kept_in_any_order(rule.letters.letters_of(numbers), begins)
    return objects[stack.of_type(kind)[objects] & ~are_kept]


def _doubtful_objects(rule: StackedRule, reader: StackReader, busy: Mask) -> Indices:
    """The objects for the only variable that letters alone do not show to be kept.

    They are present in some ``busy`` state. Letters are computed only where some read changes.
    Reads that are expensive, being computed from several values, are taken to be anything.
    """
    stack, (variable,), (kind,) = reader.stack, rule.variables, rule.types
    suits = stack.of_type(kind)
    if isinstance(busy, np.ndarray):
        before = np.concatenate([[0], busy.cumsum()])
        suits = suits & (before[stack.lasts + 1] > before[stack.firsts])
    if not suits.any():
        return _NONE
    changes = stack.are_first.copy()
    for read in rule.reads:
        own = None if read.is_composed else reader.changes(read)
        if own is not None:
            changes |= own
    cells = changes.nonzero()[0]
    if not suits.all():
        cells = cells[suits[stack.object_of[cells]]]
    if not len(cells):
        return _NONE
    spots = Spots(stack.state_of[cells], {variable: cells})
    numbers = [
        read.unknown if read.is_composed else reader.numbers(read, spots) for read in rule.reads
    ]
    letters = rule.letters.letters_of(numbers)
    begins = stack.are_first[cells].nonzero()[0]
    objects: Indices = stack.object_of[cells[begins]]
    return objects[~rule.are_kept_in_any_order(letters, begins)]


def _are_busy(rule: StackedRule, letters: Numbers) -> Mask:
    """Where letters may have an effect; one flag if all places have the same letter."""
    flags: NDArray[np.bool_] = rule.busy_flags()
    return flags.take(letters) if isinstance(letters, np.ndarray) else flags[letters]


def _busy_cells(
    rule: StackedRule,
    reader: StackReader,
    busy: Mask,
    about: tuple[str, str],
) -> Indices:
    """The cells of objects for a variable in which a letter may have an effect."""
    (variable, kind), stack = about, reader.stack
    cells, states = stack.cells_of_type(kind), stack.states_of_type(kind)
    is_every = bool(busy.all())
    if isinstance(busy, np.ndarray) and not is_every:
        there = busy[states]
        cells, states = cells[there], states[there]
    if not len(cells):
        return cells
    spots = Spots(states, {variable: cells}, kind=kind if is_every else None)
    are_busy = _are_busy(
        rule, rule.letters.letters_of(numbers_at(rule, reader, spots, (variable,)))
    )
    return cells[are_busy] if isinstance(are_busy, np.ndarray) else cells if are_busy else _NONE


def _pairs(
    rule: StackedRule, reader: StackReader, first: Indices, second: Indices
) -> tuple[Indices, Indices]:
    """The pairs of objects with cells in the same state in which a letter may have an effect."""
    stack = reader.stack
    n_objects = len(stack.types)
    pairs_met = [np.empty(0, dtype=np.intp)]
    for left, right in _cells_met(first, second, stack):
        differ = stack.object_of[left] != stack.object_of[right]
        left, right = left[differ], right[differ]
        cells = dict(zip(rule.variables, (left, right), strict=True))
        numbers = numbers_at(rule, reader, Spots(stack.state_of[left], cells), rule.variables)
        busy = np.broadcast_to(_are_busy(rule, rule.letters.letters_of(numbers)), len(left))
        pairs = stack.object_of[left[busy]] * n_objects + stack.object_of[right[busy]]
        pairs_met.append(np.unique(pairs))
    every = np.unique(np.concatenate(pairs_met))
    return every // n_objects, every % n_objects


def _cells_met(first: Indices, second: Indices, stack: Stack) -> Iterator[tuple[Indices, Indices]]:
    """The pairs of cells in the same state, some at a time."""
    second = second[stack.state_of[second].argsort(kind="stable")]
    states, theirs = stack.state_of[first], stack.state_of[second]
    begins = theirs.searchsorted(states, side="left")
    counts = theirs.searchsorted(states, side="right") - begins
    parts = counts.cumsum() // _MOST_TOGETHER
    for part in np.unique(parts):
        own = (parts == part).nonzero()[0]
        repeats = counts[own]
        places, _ = ranges(begins[own], repeats)
        yield first[own].repeat(repeats), second[places]
