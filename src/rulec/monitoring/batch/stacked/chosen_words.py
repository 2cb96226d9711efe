"""The words of a rule for choices of objects in all traces, and what has been found of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.stacked.entangled_letters import EntangledLetters
from rulec.monitoring.batch.stacked.instances import (
    Instances,
    NumbersAt,
)
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.uncertain_machine import Answer
from rulec.trace import Value
from rulec.trace.plain_arrays import ranges
from rulec.vocabulary.partial_values import UNKNOWN


class WordLetters(NamedTuple):
    """The letters of some words, if unknown constants have the ``supposed`` values.

    ``numbers`` are those of the reads and ``letters`` those of the letter sets. Where letters are
    ``entangled``, the numbers of the reads do not determine them.
    """

    supposed: Mapping[Subject, Value]
    numbers: Mapping[int, Numbers]
    letters: NDArray[np.intp]
    entangled: EntangledLetters | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ChosenWords:
    """The words of some choices of objects, of which the same constants are ``unknown``.

    Words begin and end at ``bounds`` of the ``spots``. ``supposed`` are the values that constants
    may have together, and each of them can be if that ``is_exact``.
    """

    instances: Instances
    bounds: NDArray[np.intp]
    spots: Spots
    numbers: NumbersAt
    unknown: Sequence[int] = ()
    supposed: Sequence[Mapping[Subject, Value]] = ({},)
    is_exact: bool = True

    @staticmethod
    def of(rule: StackedRule, reader: StackReader, instances: Instances) -> ChosenWords:
        """The words of some choices, with no supposed values."""
        bounds, spots = instances.spots(rule, reader.stack)
        return ChosenWords(instances, bounds, spots, NumbersAt(rule, reader, spots))

    def part(
        self, rule: StackedRule, reader: StackReader, members: NDArray[np.intp]
    ) -> ChosenWords:
        """Some of the words."""
        if len(members) == len(self.instances.traces):
            return self
        instances = self.instances.part(members)
        bounds, spots = instances.spots(rule, reader.stack)
        at, _ = ranges(self.bounds[members], bounds[1:] - bounds[:-1])
        numbers = self.numbers.part(spots, at)
        return replace(self, instances=instances, bounds=bounds, spots=spots, numbers=numbers)


@dataclass(frozen=True, slots=True, eq=False)
class StackedOutcomes:
    """The answers for words that are not kept, by their places; None for those that are odd.

    ``letters`` are those for each way to suppose unknown constants.
    """

    rule: StackedRule
    words: ChosenWords
    letters: Sequence[WordLetters]
    answers: Mapping[int, Answer | None]


def _alike(flags: NDArray[np.bool_]) -> Iterator[tuple[NDArray[np.intp], list[int]]]:
    """Groups of columns that have the same flags, each with the rows that are set."""
    if not flags.any():
        yield np.arange(flags.shape[1]), []
        return
    rows, kinds = np.unique(flags.T, axis=0, return_inverse=True)
    for kind, row in enumerate(rows):
        yield (kinds.ravel() == kind).nonzero()[0], row.nonzero()[0].tolist()


def by_unknown_constants(
    rule: StackedRule, reader: StackReader, instances: Instances, rulebook: CompiledRulebook
) -> Iterator[ChosenWords]:
    """The choices, grouped by which constants are unknown."""
    chosen = ChosenWords.of(rule, reader, instances)
    constants = rule.constants
    if not constants:
        yield chosen
        return
    are_unknown = np.zeros((len(constants), len(instances.traces)), dtype=bool)
    for row, place in enumerate(constants):
        own = np.broadcast_to(np.asarray(chosen.numbers[place]), (len(chosen.spots.states),))
        are_unknown[row] = own[chosen.bounds[:-1]] == rule.reads[place].unknown
    for members, unknown in _alike(are_unknown):
        which = tuple([constants[row] for row in unknown])
        supposed, is_exact = rule.suppositions(which, rulebook)
        own_part = chosen.part(rule, reader, members)
        yield replace(own_part, unknown=which, supposed=supposed, is_exact=is_exact)


def hides_constants(rule: StackedRule, reader: StackReader, spots: Spots) -> NDArray[np.bool_]:
    """Where constants are unknown that sums and counts read, with no supposed values."""
    stack = reader.stack
    hidden = np.zeros(len(spots.states), dtype=bool)
    for name in rule.hidden:
        column = stack.column(name)
        if column is None:
            hidden |= stack.default(name) is UNKNOWN
        elif column.unknown is not None:
            traces = stack.traces_at(name, column.unknown.nonzero()[0])
            first, end = stack.begins[traces], stack.begins[np.array(traces, dtype=np.intp) + 1]
            for begin, last in zip(first.tolist(), end.tolist(), strict=True):
                hidden |= (begin <= spots.states) & (spots.states < last)
    return hidden
