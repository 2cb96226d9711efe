"""Why verdicts on traces in arrays are open, computed on demand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.automata.mealy_monitor import NumberRead
from rulec.logic import formula as ltl
from rulec.logic.free_names import reads_in
from rulec.monitoring.batch.stacked.chosen_words import StackedOutcomes
from rulec.monitoring.batch.stacked.entangled_letters import digits_at
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.batch.stacked.stacked_read import StackedRead
from rulec.monitoring.uncertainty.state_letters.letter_classes import PossibleWord
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters
from rulec.monitoring.uncertainty.suppositions import by_name
from rulec.monitoring.uncertainty.within_tolerance import told_within_bounds
from rulec.monitoring.verdict import OpenReasons
from rulec.vocabulary.partial_values import UNKNOWN

_Value = TypeVar("_Value")


class StackedReasons:
    """Why verdicts are open; equal words of a rule have equal reasons, except for tolerances."""

    def __init__(self, reader: StackReader) -> None:
        self._reader = reader
        self._order = tuple(reader.stack.vocabulary.declarations)
        self._said: dict[str, tuple[Flags | None, Flags | None]] = {}
        self._of_type: dict[tuple[str | None, str], Flags] = {}

    def of(self, found: StackedOutcomes, place: int) -> OpenReasons:
        """Why the verdict on one of these words is open."""
        possible, constants, is_exact = self._possible_words(found, place)
        reasons = found.rule.machine.reasons(possible, constants, self._order)
        reasons = reasons._replace(exact=reasons.exact and is_exact)
        instances = found.words.instances
        stretch = slice(int(instances.firsts[place]), int(instances.lasts[place]) + 1)
        return told_within_bounds(reasons, lambda name: self._is_within_bounds(name, stretch))

    def beyond(self, found: StackedOutcomes, place: int, names: Set[str]) -> frozenset[str]:
        """The names other than these on which a verdict depends, found without all reasons."""
        if not _are_more_unknown(found, place, names):
            return frozenset()
        possible, constants, _ = self._possible_words(found, place)
        return found.rule.machine.depends_beyond(possible, constants, self._order, names)

    def _possible_words(
        self, found: StackedOutcomes, place: int
    ) -> tuple[list[PossibleWord], list[Mapping[str, object]], bool]:
        """One of these words for each choice of unknown constants, and whether it is exact."""
        rule, words = found.rule, found.words
        own, is_exact = _states_of(found, place), words.is_exact
        possible: list[PossibleWord] = []
        constants: list[Mapping[str, object]] = []
        for supposed, numbers, letters, entangled in found.letters:
            columns = [_part(numbers[n], own) for n in range(len(rule.reads))]
            if entangled is not None:
                columns.append(np.array(entangled.at(np.arange(own.start, own.stop))))
            starts, lengths = _runs(columns, own.stop - own.start)
            starts += own.start
            digits = [digits_at(rule, n, numbers[n], starts) for n in range(len(rule.reads))]
            spots = words.spots.part(own)
            unknown = [
                self._unknown_names(read, column, spots)
                for read, column in zip(rule.reads, digits, strict=True)
            ]
            sets = rule.letters.sets
            classes = [sets[number] for number in letters[starts].tolist()]
            cubes = zip(*digits, strict=True) if digits else [()] * len(starts)
            states: list[Letters] = [(cube,) for cube in cubes]
            if entangled is not None:
                for run, number in enumerate(entangled.at(starts)):
                    if number >= 0:
                        states[run] = entangled.letters[number]
                        is_exact = is_exact and entangled.exact[number]
            word = PossibleWord(
                tuple(_repeated(classes, lengths)),
                exact=True,
                find_states=partial(tuple, _repeated(states, lengths)),
                find_unknown=partial(tuple, unknown),
            )
            possible.append(word)
            constants.append(by_name(supposed))
        return possible, constants, is_exact

    def _unknown_names(
        self, stacked: StackedRead, digits: list[int], spots: Spots
    ) -> frozenset[str]:
        """The names with some unknown values."""
        if all(mask & (mask - 1) == 0 for mask in set(digits)):
            return frozenset()
        if len(stacked.names) == 1:
            return frozenset(stacked.names)
        if stacked.count is not None:
            return self._unknown_in_count(stacked.count, spots)
        assert isinstance(stacked.read, NumberRead), "it has several names"
        stack, unknown = self._reader.stack, set()
        for _, term in stacked.read.terms:
            assert isinstance(term, ltl.QuantityTerm), "it counts nothing"
            column = stack.column(term.name)
            flags = None if column is None else column.partial
            if column is None:
                is_unknown = stack.default(term.name) is UNKNOWN
            else:
                where = self._reader.where(term.arguments, spots)
                is_unknown = flags is not None and bool(flags[where].any())
            if is_unknown:
                unknown.add(term.name)
        return frozenset(unknown)

    def _unknown_in_count(self, count: ltl.Count, spots: Spots) -> frozenset[str]:
        """The names with unknown values that decide whether objects count."""
        stack, unknown = self._reader.stack, set()
        there = self._are_there(count.type)[spots.states]
        for read in reads_in(count.body):
            assert not isinstance(read, ltl.Count), "it counts nothing"
            name, arguments = read.name, read.arguments
            column = stack.column(name)
            flags = None if column is None else column.partial
            if column is None:
                is_unknown = there & (stack.default(name) is UNKNOWN)
            elif flags is None:
                continue
            elif not arguments:
                is_unknown = there & flags[spots.states]
            elif arguments[0] == count.variable:
                is_unknown = self._of_anybody(name, count.type, flags)[spots.states]
            else:
                is_unknown = there & flags[spots.cells[arguments[0]]]
            if is_unknown.any():
                unknown.add(name)
        return frozenset(unknown)

    def _are_there(self, kind: str) -> Flags:
        """The states in which some object of a type is present."""
        return self._of_anybody(None, kind, None)

    def _of_anybody(self, name: str | None, kind: str, flags: Flags | None) -> Flags:
        """The states in which the flag of a name is set for some object of a type."""
        if (name, kind) not in self._of_type:
            stack = self._reader.stack
            cells = stack.cells_of_type(kind)
            flagged: Flags = np.zeros(stack.n_states, dtype=bool)
            flagged[stack.state_of[cells if flags is None else cells[flags[cells]]]] = True
            self._of_type[name, kind] = flagged
        return self._of_type[name, kind]

    def _is_within_bounds(self, name: str, states: slice) -> bool:
        """Whether some number is an interval in these states, and none is entirely unknown."""
        if name not in self._said:
            self._said[name] = self._flags(name)
        unknown, apart = self._said[name]
        if apart is None or not apart[states].any():
            return False
        return unknown is None or not bool(unknown[states].any())

    def _flags(self, name: str) -> tuple[Flags | None, Flags | None]:
        """The states in which a name is unknown for some object, and those where it is an interval.

        An entirely unknown number has no bounds.
        """
        column = self._reader.stack.column(name)
        if column is None:
            return None, None
        apart = column.apart
        if apart is not None and column.unknown is not None:
            apart = apart & ~column.unknown
        return self._in_states(name, column.unknown), self._in_states(name, apart)

    def _in_states(self, name: str, flags: Flags | None) -> Flags | None:
        stack = self._reader.stack
        if flags is None or not stack.arity[name]:
            return flags
        flagged: NDArray[np.bool_] = np.zeros(stack.n_states, dtype=bool)
        flagged[stack.states_at(name, flags.nonzero()[0])] = True
        return flagged


def _are_more_unknown(found: StackedOutcomes, place: int, names: Set[str]) -> bool:
    """Whether one of these words has, or may have, unknown values of names other than these."""
    if any(name not in names for own in found.letters for name, _ in own.supposed):
        return True
    own, rule = _states_of(found, place), found.rule
    others = [n for n, read in enumerate(rule.reads) if not names >= {*read.names}]
    columns = [(n, numbers[n]) for _, numbers, *_ in found.letters for n in others]
    parts = ((n, x[own] if isinstance(x, np.ndarray) else x) for n, x in columns)
    return any(rule.letters.are_partial({n: part}, (n,)).any() for n, part in parts)


def _states_of(found: StackedOutcomes, place: int) -> slice:
    """The spots of one of the words."""
    begin, end = found.words.bounds[place : place + 2].tolist()
    return slice(begin, end)


def _part(column: Numbers, own: slice) -> NDArray[np.intp]:
    if isinstance(column, np.ndarray):
        return column[own]
    return np.broadcast_to(np.intp(column), (own.stop - own.start,))


def _runs(columns: Sequence[NDArray[np.intp]], length: int) -> tuple[NDArray[np.intp], list[int]]:
    """The first state of each run in which all columns are constant, and the runs' lengths."""
    changes = np.zeros(length, dtype=bool)
    changes[0] = True
    for column in columns:
        changes[1:] |= column[1:] != column[:-1]
    starts = changes.nonzero()[0]
    return starts, np.diff(starts, append=length).tolist()


def _repeated(values: Sequence[_Value], lengths: Sequence[int]) -> list[_Value]:
    """Each value repeated as often as its length says."""
    repeated: list[_Value] = []
    for value, length in zip(values, lengths, strict=True):
        repeated += [value] * length
    return repeated
