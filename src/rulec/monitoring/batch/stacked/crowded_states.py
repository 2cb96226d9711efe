"""The joint values of reads that count all objects, found once for states that are alike.

For objects that are only counted, names do not matter, only how many of them have the same values,
up to the highest threshold of a count. So dense traffic has few different states.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.columns.column_numbers import alike_places
from rulec.monitoring.batch.columns.encoded_columns import PartlyKnown
from rulec.monitoring.batch.stacked.stack_reader import Spots, StackReader
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.uncertainty.state_letters.counted_crowd import count_in, enough_alike
from rulec.monitoring.uncertainty.state_letters.entangled_reads import EntangledReads
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.trace import Value
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, PartialValue

MOST_KINDS = 1 << 7
"""If objects have more different combinations of values, states are evaluated one by one."""


@dataclass(frozen=True, slots=True, eq=False)
class _AlikeStates:
    """The group of each state, and the position of the first state of each group.

    ``often`` is how often each kind of object occurs in a state, ``examples`` are cells of each
    kind.
    """

    firsts: Indices
    groups: Indices
    often: NDArray[np.intp]
    examples: Indices


class CrowdedStates:
    """The states of a stack, for a rule without variables that counts all objects.

    ``is_known`` is false if each state has to be evaluated by itself.
    """

    def __init__(self, rule: StackedRule, reader: StackReader) -> None:
        self._rule, self._reader, self._stack = rule, reader, reader.stack
        reads = [rule.reads[n].read for n in rule.related]
        enough = enough_alike(reads)
        self._enough = 0 if enough is None else enough
        self.is_known = enough is not None and not rule.variables
        names = sorted(
            rule.in_facts.union(name for n in rule.related for name in rule.reads[n].names)
        )
        declared = self._stack.vocabulary.declarations
        self._world = [name for name in names if not declared[name].parameters]
        self._about = [name for name in names if declared[name].parameters]
        self._counted = sorted({count.type for count in map(count_in, reads) if count is not None})
        self._known: tuple[Indices, _AlikeStates | None] | None = None
        self._numbers: dict[tuple[Value | None, ...], tuple[EntangledReads, list[int]]] = {}

    @cached_property
    def are_entangled(self) -> Flags:
        """The states of the stack in which unknown values may depend on each other."""
        stack = self._stack
        everybody = {f"{kind} {n}": kind for kind in self._counted for n in range(2)}
        shared = {name for name, _ in self._rule.reads_among(everybody).shared}
        entangled = np.zeros(stack.n_states, dtype=bool)
        cells = self._cells(entangled | True)
        for name in (*self._world, *self._about):
            column = stack.column(name)
            if column is None:
                entangled |= name in shared and stack.default(name) is UNKNOWN
                continue
            flags = column.partial if name in shared else column.apart
            if flags is not None and name in self._world:
                entangled |= flags
            elif flags is not None:
                entangled[stack.state_of[cells[flags[cells]]]] = True
        return entangled

    def numbers(
        self, states: Indices, supposed: Mapping[Subject, Value]
    ) -> tuple[EntangledReads, list[int]] | None:
        """The rule's entangled reads, and the place of their joint letters in each state.

        States are in ascending order. None if each has to be evaluated by itself.
        """
        alike = self._alike(states)
        if alike is None:
            return None
        # Most supposed values are not read by these reads
        own = tuple([supposed.get((name, ())) for name in self._world])
        if own not in self._numbers:
            often = alike.often[alike.firsts]
            reads, numbers = self._numbers_of(states[alike.firsts], often, alike.examples, own)
            self._numbers[own] = reads, np.array(numbers, dtype=np.intp)[alike.groups].tolist()
        return self._numbers[own]

    def _alike(self, states: Indices) -> _AlikeStates | None:
        """The states in groups that are alike.

        Cached, since mostly the same states are asked about again.
        """
        if self._known is None or not np.array_equal(self._known[0], states):
            self._known = states, self._grouped(states)
            self._numbers = {}
        return self._known[1]

    def _grouped(self, states: Indices) -> _AlikeStates | None:
        stack = self._stack
        is_meant = np.zeros(stack.n_states, dtype=bool)
        is_meant[states] = True
        cells = self._cells(is_meant)
        kinds = self._kinds(cells)
        n_kinds = int(kinds.max(initial=-1)) + 1
        if n_kinds > MOST_KINDS:
            return None
        owners = states.searchsorted(stack.state_of[cells])
        often = np.bincount(owners * n_kinds + kinds, minlength=len(states) * n_kinds)
        often = np.minimum(often, self._enough).reshape(len(states), n_kinds)
        columns = [codes for name in self._world for codes in _codes(stack.column(name), states)]
        groups = alike_places((*often.T, *columns), len(states))
        firsts = np.empty(int(groups.max(initial=-1)) + 1, dtype=np.intp)
        firsts[groups[::-1]] = np.arange(len(states))[::-1]
        examples = np.empty(n_kinds, dtype=np.intp)
        examples[kinds[::-1]] = cells[::-1]
        return _AlikeStates(firsts, groups, often, examples)

    def _cells(self, states: Flags) -> Indices:
        """The cells, in some states, of the objects that may count."""
        stack = self._stack
        suits = np.zeros(len(stack.types), dtype=bool)
        for kind in self._counted:
            suits |= stack.of_type(kind)
        return (suits[stack.object_of] & states[stack.state_of]).nonzero()[0]

    def _kinds(self, cells: Indices) -> Indices:
        """A number for each cell, equal for cells with the same values of objects of one type."""
        stack = self._stack
        columns = (codes for name in self._about for codes in _codes(stack.column(name), cells))
        return alike_places((stack.kind_of[stack.object_of[cells]], *columns), len(cells))

    def _numbers_of(
        self,
        states: Indices,
        often: NDArray[np.intp],
        examples: Indices,
        supposed: Sequence[Value | None],
    ) -> tuple[EntangledReads, list[int]]:
        """The places of the joint letters in states that contain these example objects this often.

        ``supposed`` has the supposed values of the world's names, or None.
        """
        stack, reader = self._stack, self._reader
        types = [stack.types[item] for item in stack.object_of[examples].tolist()]
        spots = Spots(stack.state_of[examples], {"": examples})
        about = {name: reader.values_at(name, ("",), spots) for name in self._about}
        world = {
            name: supposed_instead(reader.values_at(name, (), Spots(states, {})), value)
            for name, value in zip(self._world, supposed, strict=True)
        }
        there: list[dict[str, int]] = []
        for row in often.tolist():
            n_of_type: Counter[str] = Counter()
            own: dict[str, int] = {}
            for kind, n in enumerate(row):
                for _ in range(n):
                    own[f"{types[kind]} {n_of_type[types[kind]]}"] = kind
                    n_of_type[types[kind]] += 1
            there.append(own)
        everybody = {item: types[kind] for own in there for item, kind in own.items()}
        reads = self._rule.reads_among(everybody)
        numbers = []
        for place, own in enumerate(there):
            values = [
                world[name][place]
                if not items
                else about[name][own[items[0]]]
                if items[0] in own
                else None
                for name, items in reads.subjects
            ]
            objects = {item: types[kind] for item, kind in own.items()}
            numbers.append(reads.number(tuple(values), objects))
        return reads, numbers


def supposed_instead(
    values: Sequence[PartialValue | None], instead: Value | None
) -> Sequence[PartialValue | None]:
    """The values, with the supposed value instead of unknown ones."""
    if instead is None:
        return values
    return [instead if type(value) in UNKNOWN_TYPES else value for value in values]


def _codes(column: PartlyKnown | None, where: Indices) -> list[Indices]:
    """Numbers for the values of a column at some places, equal where the values are equal."""
    if column is None:
        return []
    ends = [column.values] if column.upper is None else [column.values, column.upper]
    codes = [np.unique(end[where], return_inverse=True)[1] + 1 for end in ends]
    if column.unknown is not None:
        codes = [np.where(column.unknown[where], 0, own) for own in codes]
    return codes
