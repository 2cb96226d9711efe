"""Where the states of traces end to end are, and the values about their objects.

The states of all traces follow each other, trace by trace; values about objects are in *cells*, one
for each state in which an object is present, object by object.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.joined.object_pairs import ObjectPairs
from rulec.trace.plain_arrays import ranges
from rulec.trace.trace_arrays import starts_of
from rulec.vocabulary import Vocabulary


class TracePlaces:
    """The places of states and cells of traces of these ``lengths``, with any objects.

    ``begins`` is where the states of each trace begin, ``starts`` where the cells of each object
    do; both have the total length as last entry. ``trace_of``, ``firsts`` and ``lasts`` are each
    object's trace and its first and last state among all; ``kind_of`` is the number of its type
    among the ``kinds``. ``spans`` (objects x 2) are their first and last states in their traces.
    """

    def __init__(
        self,
        lengths: Indices,
        n_objects: Sequence[int] | Indices,
        spans: Indices,
        types: Sequence[str],
        vocabulary: Vocabulary,
    ) -> None:
        self.vocabulary = vocabulary
        self.begins = np.concatenate([np.zeros(1, dtype=np.intp), lengths.cumsum()])
        self.n_states = int(self.begins[-1])
        self.trace_of = np.arange(len(lengths)).repeat(n_objects)
        self.firsts = spans[:, 0] + self.begins[self.trace_of]
        self.lasts = spans[:, 1] + self.begins[self.trace_of]
        self.starts = starts_of(spans)
        self.types = types
        self.kinds = tuple(dict.fromkeys(types))
        numbers = {kind: number for number, kind in enumerate(self.kinds)}
        self.kind_of: Indices = np.array([numbers[kind] for kind in types], dtype=np.intp)
        self._fits: dict[str, tuple[bool, ...]] = {}
        self._of_type: dict[str, Flags] = {}
        self._cells_of_type: dict[str, Indices] = {}
        self._states_of_type: dict[str, Indices] = {}

    @cached_property
    def n_cells(self) -> Indices:
        """The number of cells of each object."""
        return self.starts[1:] - self.starts[:-1]

    @cached_property
    def object_of(self) -> Indices:
        """The object of each cell."""
        return np.arange(len(self.types)).repeat(self.n_cells)

    @cached_property
    def state_of(self) -> Indices:
        """The state of each cell."""
        shift: Indices = self.firsts - self.starts[:-1]
        return np.arange(self.starts[-1]) + shift.repeat(self.n_cells)

    @cached_property
    def are_first(self) -> Flags:
        """The first cell of each object."""
        are_first: Flags = np.zeros(self.starts[-1], dtype=bool)
        are_first[self.starts[:-1][self.firsts <= self.lasts]] = True
        return are_first

    def _kinds_of(self, kind: str) -> tuple[bool, ...]:
        """Which of the ``kinds`` are a type or one of its subtypes."""
        if kind not in self._fits:
            is_subtype = self.vocabulary.is_subtype
            self._fits[kind] = tuple([is_subtype(own, kind) for own in self.kinds])
        return self._fits[kind]

    def of_type(self, kind: str) -> Flags:
        """Which objects are of a type or one of its subtypes."""
        if kind not in self._of_type:
            self._of_type[kind] = np.array(self._kinds_of(kind), dtype=bool)[self.kind_of]
        return self._of_type[kind]

    def has_type(self, kind: str) -> bool:
        """Whether some object is of a type or one of its subtypes."""
        return any(self._kinds_of(kind))

    def all_are(self, kind: str) -> bool:
        """Whether all objects are of a type or one of its subtypes."""
        return all(self._kinds_of(kind))

    def cells_of_type(self, kind: str) -> Indices:
        """The cells of the objects of a type."""
        if kind not in self._cells_of_type:
            every = np.arange(self.starts[-1])
            are_all = self.all_are(kind)
            self._cells_of_type[kind] = (
                every if are_all else every[self.of_type(kind)[self.object_of]]
            )
        return self._cells_of_type[kind]

    def states_of_type(self, kind: str) -> Indices:
        """The states of the cells of the objects of a type."""
        if kind not in self._states_of_type:
            cells = self.cells_of_type(kind)
            is_every = len(cells) == self.starts[-1]
            self._states_of_type[kind] = self.state_of if is_every else self.state_of[cells]
        return self._states_of_type[kind]

    def pairs_of(self, objects: Indices) -> ObjectPairs:
        """Pairs of objects (pairs x 2), and the states in which both are present."""
        spans = [self.firsts[objects].max(axis=1), self.lasts[objects].min(axis=1)]
        return ObjectPairs(objects, len(self.types), np.stack(spans, axis=1))

    def pairs_present(self, first: Indices, second: Indices) -> tuple[Indices, Indices]:
        """The pairs of different objects of one trace that are present together."""
        own, others = self.trace_of[first], self.trace_of[second]
        begins = others.searchsorted(own, side="left")
        counts = others.searchsorted(own, side="right") - begins
        places, _ = ranges(begins, counts)
        left, right = first.repeat(counts), second[places]
        since = np.maximum(self.firsts[left], self.firsts[right])
        met = (left != right) & (since <= np.minimum(self.lasts[left], self.lasts[right]))
        return left[met], right[met]
