"""The letters of states in which a rule reads unknown values that depend on each other.

In such states the numbers of the single reads do not determine which letters are possible.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.monitoring.batch.stacked.crowded_states import CrowdedStates, supposed_instead
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.uncertainty.state_letters.entangled_reads import EntangledReads
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Columns, Numbers
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.trace import Value
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue


@dataclass(frozen=True, slots=True, eq=False)
class EntangledLetters:
    """The possible ``letters`` at some ``places``, with their ``classes`` as bits.

    ``numbers`` gives the place of each one's letters among these; ``exact`` says whether all of
    them are possible.
    """

    places: NDArray[np.intp]
    numbers: NDArray[np.intp]
    letters: tuple[Letters, ...]
    exact: tuple[bool, ...]
    classes: tuple[int, ...]

    def at(self, places: NDArray[np.intp]) -> list[int]:
        """The number of the letters at each of some places; -1 where they are not entangled."""
        if not len(self.places):
            return [-1] * len(places)
        near = np.minimum(self.places.searchsorted(places), len(self.places) - 1)
        numbers: list[int] = np.where(self.places[near] == places, self.numbers[near], -1).tolist()
        return numbers


def entangled_letters(
    rule: StackedRule,
    reader: StackReader,
    about: tuple[Spots, Flags],
    numbers: Columns,
    supposed: Mapping[Subject, Value],
    *,
    crowd: CrowdedStates,
) -> EntangledLetters | None:
    """The letters where some related reads are ``partial`` and their values are entangled.

    ``about`` are the spots, and where reads are partial. None if these have to be evaluated one by
    one. The ``crowd`` are the states, for rules that count all objects.
    """
    spots, partial = about
    joint: Sequence[int]
    if rule.entangled is not None:
        reads = rule.entangled
        places = (partial & _are_entangled(reads, reader, spots)).nonzero()[0]
        joint = list(map(reads.number, _rows(reads, reader, spots.part(places), supposed)))
    else:
        if not crowd.is_known:
            return None
        places = (partial & crowd.are_entangled[spots.states]).nonzero()[0]
        crowded = crowd.numbers(spots.states[places], supposed)
        if crowded is None:
            return None
        reads, joint = crowded
    letters = rule.machine.classes.of_rule(rule.rule, reads)
    digits_told = (numbers[n] for n in letters.independent)
    varying = [crowded[places] for crowded in digits_told if isinstance(crowded, np.ndarray)]
    different, which = _different(varying, joint)
    digits = [digits_at(rule, n, numbers[n], places[different]) for n in letters.independent]
    keys: dict[tuple[int, ...], int] = {}
    alike = [joint[place] for place in different.tolist()]
    own = [keys.setdefault(key, len(keys)) for key in zip(*digits, alike, strict=True)]
    return EntangledLetters(
        places,
        np.array(own, dtype=np.intp)[which],
        tuple(map(letters.letters, keys)),
        tuple([reads.joint_letters[key[-1]][1] for key in keys]),
        tuple(map(letters.classes.__getitem__, keys)),
    )


def _different(
    digits: Sequence[NDArray[Any]], joint: Sequence[int]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The distinct combinations of digits and joint letters.

    Gives the first place of each, and for each place the number of its combination.
    """
    _, firsts, which = np.unique(joint, return_index=True, return_inverse=True)
    for own in digits:
        codes = which * (int(own.max(initial=0)) + 1) + own.astype(np.intp)
        _, firsts, which = np.unique(codes, return_index=True, return_inverse=True)
    order = firsts.argsort()
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order))
    return firsts[order], rank[which]


def _are_entangled(reads: EntangledReads, reader: StackReader, spots: Spots) -> Flags:
    """Where unknown values depend on each other."""
    entangled = np.zeros(len(spots.states), dtype=bool)
    for about in reads.subjects:
        name, variables = about
        column = reader.stack.column(name)
        if column is None:
            if about in reads.shared and reader.stack.default(name) is UNKNOWN:
                entangled[:] = True
            continue
        flags = column.partial if about in reads.shared else column.apart
        if flags is not None:
            entangled |= flags[reader.where(variables, spots)]
    return entangled


def _rows(
    reads: EntangledReads,
    reader: StackReader,
    spots: Spots,
    supposed: Mapping[Subject, Value],
) -> Iterator[tuple[PartialValue | None, ...]]:
    """The values of the reads' subjects at some spots."""
    columns = [
        supposed_instead(reader.values_at(*subject, spots), supposed.get(subject))
        for subject in reads.subjects
    ]
    return zip(*columns, strict=True) if columns else iter([()] * len(spots.states))


def digits_at(
    rule: StackedRule, read: int, numbers: Numbers, places: NDArray[np.intp] | slice
) -> list[int]:
    """The digits, as bits, that a read may have at some places of its numbers."""
    meanings = rule.reads[read].meanings
    if isinstance(numbers, np.ndarray):
        return [meanings[number] for number in numbers[places].tolist()]
    n_places = places.stop - places.start if isinstance(places, slice) else len(places)
    return [meanings[numbers]] * n_places
