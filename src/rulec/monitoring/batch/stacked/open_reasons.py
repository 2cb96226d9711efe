"""Why verdicts on traces in arrays are open, found when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import Read
from rulec.logic import formula as ltl
from rulec.monitoring.batch.stacked.stack_reader import StackReader, is_partial
from rulec.monitoring.batch.stacked.stacked_outcomes import StackedWords, digits_at
from rulec.monitoring.uncertainty.state_letters.letter_diagram import Numbers
from rulec.monitoring.uncertainty.state_letters.possible_letters import PossibleWord
from rulec.monitoring.uncertainty.within_tolerance import told_within_bounds
from rulec.monitoring.verdict import OpenReasons
from rulec.trace.trace_arrays import Flags

_Value = TypeVar("_Value")


class StackedReasons:
    """Why verdicts are open; equal words of one rule have equal reasons, but for tolerances."""

    def __init__(self, reader: StackReader) -> None:
        self._reader = reader
        self._order = tuple(reader.stack.vocabulary.declarations)
        self._said: dict[str, tuple[Flags | None, Flags | None]] = {}

    def of(self, words: StackedWords, place: int) -> OpenReasons | None:
        """Why the verdict on one of these words is open; None if one has to look closer."""
        own = slice(int(words.bounds[place]), int(words.bounds[place + 1]))
        if words.entangled[own].any():
            return None
        possible, constants = [], []
        for supposed, numbers, letters in zip(
            words.supposed, words.numbers, words.letters, strict=True
        ):
            rule = words.rule
            starts, lengths = _runs([_part(column, own) for column in numbers])
            places = starts + own.start
            digits = [digits_at(rule, n, numbers[n], places) for n in range(len(rule.reads))]
            unknown = []
            for n, column in enumerate(digits):
                names = self._unknown_names(words, n, column, own)
                if names is None:
                    return None
                unknown.append(names)
            sets = rule.letters.sets
            classes = [sets[number] for number in letters[places].tolist()]
            states = [(cube,) for cube in zip(*digits, strict=True)]
            word = PossibleWord(
                tuple(_repeated(classes, lengths)),
                exact=True,
                find_states=partial(tuple, _repeated(states, lengths)),
                find_unknown=partial(tuple, unknown),
            )
            possible.append(word)
            constants.append(_by_name(supposed))
        found = words.rule.machine.reasons(possible, constants, self._order)
        found = found._replace(exact=found.exact and words.is_exact)
        first, last = words.instances.firsts[place], words.instances.lasts[place]
        stretch = slice(int(first), int(last) + 1)
        return told_within_bounds(found, lambda name: self._is_within_bounds(name, stretch))

    def _unknown_names(
        self, words: StackedWords, read: int, digits: list[int], own: slice
    ) -> frozenset[str] | None:
        """The names of values of which some are unknown; None if one has to look closer."""
        stacked = words.rule.reads[read]
        if all(mask & (mask - 1) == 0 for mask in set(digits)):
            return frozenset()
        if len(stacked.names) == 1:
            return frozenset(stacked.names)
        if stacked.count is not None or isinstance(stacked.read, Read):
            return None
        spots = words.spots.part(own)
        unknown = set()
        for _, term in stacked.read.terms:
            assert isinstance(term, ltl.QuantityTerm), "it counts nothing"
            column = self._reader.stack.column(term.name)
            if column is None:
                return None
            where = spots.cells[term.arguments[0]] if term.arguments else spots.states
            flags = is_partial(column)
            if flags is not None and flags[where].any():
                unknown.add(term.name)
        return frozenset(unknown)

    def _is_within_bounds(self, name: str, states: slice) -> bool:
        """Whether some number is an interval in these states, and none is unknown altogether."""
        if name not in self._said:
            self._said[name] = self._flags(name)
        unknown, apart = self._said[name]
        if apart is None or not apart[states].any():
            return False
        return unknown is None or not bool(unknown[states].any())

    def _flags(self, name: str) -> tuple[Flags | None, Flags | None]:
        """The states in which a name is unknown of anybody, and those in which it is an interval.

        Of an unknown number there are no bounds.
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
        if flags is None or name in stack.traces[0].world:
            return flags
        found: NDArray[np.bool_] = np.zeros(stack.n_states, dtype=bool)
        found[stack.state_of[flags]] = True
        return found


def _part(column: Numbers, own: slice) -> NDArray[np.intp]:
    if isinstance(column, np.ndarray):
        return column[own]
    return np.broadcast_to(np.intp(column), (own.stop - own.start,))


def _runs(columns: Sequence[NDArray[np.intp]]) -> tuple[NDArray[np.intp], list[int]]:
    """Where states begin in which all columns stay the same, and how many each time."""
    length = len(columns[0])
    changes = np.zeros(length, dtype=bool)
    changes[0] = True
    for column in columns:
        changes[1:] |= column[1:] != column[:-1]
    starts = np.flatnonzero(changes)
    return starts, np.diff(starts, append=length).tolist()


def _repeated(values: Sequence[_Value], lengths: Sequence[int]) -> list[_Value]:
    """Each value as often as it stays."""
    found: list[_Value] = []
    for value, length in zip(values, lengths, strict=True):
        found += [value] * length
    return found


def _by_name(supposed: Mapping[tuple[str, tuple[str, ...]], object]) -> dict[str, object]:
    by_name: dict[str, object] = {}
    for (name, items), value in supposed.items():
        by_name[name] = (by_name.get(name), items, value) if items else value
    return by_name
