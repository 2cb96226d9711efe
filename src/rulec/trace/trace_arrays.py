"""One trace as arrays: values of the world and of each object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.diagnostics import RulecError
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_columns import Array
from rulec.trace.trace_model import Ending, Trace
from rulec.value_display import short_repr
from rulec.vocabulary.partial_values import UNKNOWN, Interval

Places = NDArray[np.intp] | Flags | slice


@dataclass(frozen=True, slots=True, eq=False)
class TraceArrays:
    """A trace of ``n_states`` states, ``step_s`` seconds apart, as arrays.

    ``objects`` maps each object to its type; ``spans`` (objects x 2) holds the first and the last
    state in which each is present. ``world`` has for a name one value per state; ``about`` has the
    values for the first object in the states of its span, then those for the second one, and so on:
    object ``i``'s begin at ``starts[i]``. Values are Booleans, numbers, or indices into ``texts``.

    These have the shape of their name's values: ``unknown`` marks unknown values, ``absent`` those
    that are not given; ``bounds`` are the least and the greatest value that a number can have, used
    instead of its values. ``only`` marks the objects that a name is given for; without it, all.
    ``ends`` and ``told`` are as in a ``Trace``. ``faults`` are the names that a fault of rulec has
    cost, and it; the name of one that has cost nothing is empty.
    """

    __repr__ = short_repr

    id: str
    step_s: float
    n_states: int
    objects: Mapping[str, str] = field(default_factory=dict)
    spans: NDArray[np.intp] = field(default_factory=lambda: np.empty((0, 2), dtype=np.intp))
    world: Mapping[str, Array] = field(default_factory=dict)
    about: Mapping[str, Array] = field(default_factory=dict)
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    unknown: Mapping[str, Flags] = field(default_factory=dict)
    absent: Mapping[str, Flags] = field(default_factory=dict)
    bounds: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)
    only: Mapping[str, Flags] = field(default_factory=dict)
    ends: Ending = "complete"
    told: frozenset[str] | None = None
    faults: Mapping[str, RulecError] = field(default_factory=dict, repr=False)

    @property
    def starts(self) -> NDArray[np.intp]:
        """Where the values about each object begin, and where those about the last end."""
        return starts_of(self.spans)

    def __eq__(self, other: object) -> bool:
        """Whether the states are the same."""
        return isinstance(other, TraceArrays) and self.trace() == other.trace()

    __hash__ = None  # type: ignore[assignment]

    def since(self, state: int) -> TraceArrays:
        """The trace from a state on, as if nothing were known about earlier states."""
        if not state:
            return self
        return self._of_states(np.arange(state, self.n_states), slice(state, None))

    def at(self, states: Sequence[int]) -> TraceArrays:
        """The trace of some states (ascending, distinct), and the objects present in any."""
        chosen = np.array(states, dtype=np.intp)
        return self._of_states(chosen, chosen)

    def _of_states(self, chosen: NDArray[np.intp], states: Places) -> TraceArrays:
        """The trace of the ``chosen`` states, which are at ``states`` in columns of the world."""
        first = chosen.searchsorted(self.spans[:, 0])
        last = chosen.searchsorted(self.spans[:, 1], side="right") - 1
        there = first <= last
        stays = np.zeros(self.n_states, dtype=bool)
        stays[chosen] = True
        # The state that each value in `about` belongs to
        starts = self.starts
        state_of = np.arange(starts[-1]) + (self.spans[:, 0] - starts[:-1]).repeat(np.diff(starts))
        part = self._cut(states, stays[state_of], there, self.world.keys() | self.about.keys())
        spans = np.stack([first[there], last[there]], axis=1)
        return replace(part, n_states=len(chosen), spans=spans)

    def _cut(self, states: Places, cells: Places, there: Flags, names: Set[str]) -> TraceArrays:
        """Values of ``names`` in ``states`` (world) and ``cells`` (objects marked ``there``)."""

        def part(name: str, values: Array) -> Array:
            return values[states if name in self.world else cells]

        def of(values: Mapping[str, Array]) -> dict[str, Array]:
            return {name: part(name, own) for name, own in values.items() if name in names}

        items = zip(self.objects.items(), there.tolist(), strict=True)
        return replace(
            self,
            objects=dict(item for item, is_there in items if is_there),
            spans=self.spans[there],
            world=of(self.world),
            about=of(self.about),
            unknown=of(self.unknown),
            absent=of(self.absent),
            bounds={
                name: (part(name, low), part(name, high))
                for name, (low, high) in self.bounds.items()
                if name in names
            },
            only={name: flags[there] for name, flags in self.only.items() if name in names},
        )

    @property
    def is_partial(self) -> bool:
        """Whether any given value is unknown or known only within bounds."""
        partial = [
            *self.unknown.items(),
            *((name, low != high) for name, (low, high) in self.bounds.items()),
        ]
        return any(bool((flags & self.is_given(name)).any()) for name, flags in partial)

    def says(self, name: str) -> bool:
        """Whether a name is given, even as unknown, in some state."""
        return (name in self.world or name in self.about) and bool(self.is_given(name).any())

    def is_given(self, name: str) -> Flags:
        """Mask of a name's values that are given, even as unknown."""
        column = self.world[name] if name in self.world else self.about[name]
        given = np.ones(len(column), dtype=bool)
        if name in self.absent:
            given &= ~self.absent[name]
        if name in self.about and name in self.only:
            given &= self.only[name].repeat(np.diff(self.starts))
        return given

    def part(self, names: Set[str], items: Set[str]) -> TraceArrays:
        """The trace with these names and objects only."""
        kept = np.array([item in items for item in self.objects], dtype=bool)
        return self._cut(slice(None), kept.repeat(np.diff(self.starts)), kept, names)

    def trace(self) -> Trace:
        """The trace with its states as mappings."""
        states: list[dict[str, Any]] = [{} for _ in range(self.n_states)]
        for name, column in self.world.items():
            for state, value in zip(states, self._values(name, column), strict=True):
                if value is not _NOTHING:
                    state[name] = value
        starts, spans = self.starts.tolist(), self.spans.tolist()
        for name, column in self.about.items():
            by_state: list[dict[str, Any]] = [{} for _ in range(self.n_states)]
            values, only = self._values(name, column), self.only.get(name)
            for number, (item, (first, last)) in enumerate(zip(self.objects, spans, strict=True)):
                if only is None or only[number]:
                    own = values[starts[number] : starts[number + 1]]
                    for of_objects, value in zip(by_state[first : last + 1], own, strict=True):
                        if value is not _NOTHING:
                            of_objects[item] = value
            for state, of_objects in zip(states, by_state, strict=True):
                if of_objects:
                    state[name] = of_objects
        whole = [0, self.n_states - 1]
        present = {
            item: (span[0], span[1])
            for item, span in zip(self.objects, spans, strict=True)
            if span != whole
        }
        return Trace(
            self.id,
            self.step_s,
            self.objects,
            tuple(states),
            present,
            ends=self.ends,
            told=self.told,
        )

    def _values(self, name: str, column: Array) -> list[Any]:
        """A name's values in the form that states have; ``_NOTHING`` where it is not given."""
        values: list[Any] = column.tolist()
        if name in self.texts:
            texts = self.texts[name]
            values = [texts[code] for code in values]
        elif name in self.bounds:
            ends = zip(*[bound.tolist() for bound in self.bounds[name]], strict=True)
            values = [low if low == high else Interval(low, high) for low, high in ends]
        for flags, instead in ((self.unknown, UNKNOWN), (self.absent, _NOTHING)):
            if name in flags:
                for place in flags[name].nonzero()[0].tolist():
                    values[place] = instead
        return values


def said_by(traces: Sequence[TraceArrays], names: Set[str]) -> list[TraceArrays]:
    """The traces with the values of these names only; those that share columns still do."""
    known: dict[int, dict[str, Any]] = {}

    def of(values: Mapping[str, Any]) -> Mapping[str, Any]:
        columns = values.columns if isinstance(values, SharedColumns) else values
        if id(columns) not in known:
            known[id(columns)] = {name: columns[name] for name in columns if name in names}
        chosen = known[id(columns)]
        return replace(values, columns=chosen) if isinstance(values, SharedColumns) else chosen

    return [
        replace(
            trace,
            world=of(trace.world),
            about=of(trace.about),
            unknown=of(trace.unknown),
            absent=of(trace.absent),
            bounds=of(trace.bounds),
            only=of(trace.only),
        )
        for trace in traces
    ]


def starts_of(spans: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where the values about each object begin, and where those about the last end."""
    lengths = spans[:, 1] - spans[:, 0] + 1
    return np.concatenate([np.zeros(1, dtype=np.intp), lengths.cumsum()])


_NOTHING = object()
"""Stands for a value that is not given."""
