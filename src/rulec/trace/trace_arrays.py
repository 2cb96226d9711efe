"""One trace as arrays: values of the world and of each object."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.diagnostics import RulecError
from rulec.trace.plain_arrays import ranges
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_columns import Array
from rulec.trace.trace_model import Ending, Trace
from rulec.value_display import short_repr
from rulec.vocabulary.partial_values import UNKNOWN, Interval


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
        cells = kept.repeat(np.diff(self.starts))

        def part(name: str, values: Array) -> Array:
            return values if name in self.world else values[cells]

        def of(values: Mapping[str, Array]) -> dict[str, Array]:
            return {name: part(name, own) for name, own in values.items() if name in names}

        return replace(
            self,
            objects={item: kind for item, kind in self.objects.items() if item in items},
            spans=self.spans[kept],
            world=of(self.world),
            about=of(self.about),
            unknown=of(self.unknown),
            absent=of(self.absent),
            bounds={
                name: (part(name, low), part(name, high))
                for name, (low, high) in self.bounds.items()
                if name in names
            },
            only={name: flags[kept] for name, flags in self.only.items() if name in names},
        )

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


BY_NAME = "world", "about", "unknown", "absent", "bounds", "only"
"""The fields in which traces have something by name."""

by_name = attrgetter(*BY_NAME)
"""The content of these fields."""


def stretches_of(
    traces: Sequence[TraceArrays], stretches: Sequence[range], names: Set[str]
) -> list[TraceArrays]:
    """The traces with these states and names only, as if nothing were known of others.

    Those that share columns share the shortened ones.
    """
    sharing: dict[tuple[int, ...], list[int]] = {}
    for number, trace in enumerate(traces):
        key = tuple([id(_columns(values)) for values in by_name(trace)])
        sharing.setdefault(key, []).append(number)
    cut: dict[int, TraceArrays] = {}
    for numbers in sharing.values():
        chosen = [stretches[n] for n in numbers]
        together = _shortened([traces[n] for n in numbers], chosen, names)
        cut.update(zip(numbers, together, strict=True))
    return [cut[number] for number in range(len(traces))]


def _shortened(
    traces: Sequence[TraceArrays], stretches: Sequence[range], names: Set[str]
) -> Iterator[TraceArrays]:
    """The stretches of traces that share their columns."""
    begins, ends = np.array([(own.start, own.stop) for own in stretches], dtype=np.intp).T
    counts = np.array([len(trace.spans) for trace in traces])
    of = np.arange(len(traces)).repeat(counts)
    whole = np.concatenate([trace.spans for trace in traces])
    firsts = np.maximum(whole[:, 0], begins[of])
    lasts = np.minimum(whole[:, 1], ends[of] - 1)
    there = firsts <= lasts
    at = np.array([_places(trace) for trace in traces], dtype=np.intp)
    starts = starts_of(whole)[:-1]
    n_before = np.concatenate([[0], counts.cumsum()[:-1]])
    starts = starts + (at[:, 1] - np.append(starts, 0)[n_before])[of] + firsts - whole[:, 0]
    kept, lengths = of[there], (lasts - firsts + 1)[there]
    places = (
        ranges(at[:, 0] + begins, ends - begins)[0],
        ranges(starts[there], lengths)[0],
        ranges(at[:, 2], counts)[0][there],
    )
    n_cells = np.bincount(kept, lengths, len(traces)).astype(np.intp)
    n_objects = np.bincount(kept, minlength=len(traces))
    own = [_slices(sizes) for sizes in (ends - begins, n_cells, n_objects)]
    spans = np.stack([firsts, lasts], axis=1)[there] - begins[kept, None]
    about = frozenset(_columns(traces[0].about))
    columns = {
        key: {
            name: _at(column, places[2 if key == "only" else name in about])
            for name, column in _columns(values).items()
            if name in names
        }
        for key, values in zip(BY_NAME, by_name(traces[0]), strict=True)
    }
    is_there = iter(there.tolist())
    for trace, states, cells, items in zip(traces, *own, strict=True):
        objects = [item for item in trace.objects.items() if next(is_there)]
        parts: dict[str, Any] = {
            key: SharedColumns(mine, about, *((items, items) if key == "only" else (states, cells)))
            for key, mine in columns.items()
        }
        # Copying a trace to replace most of it takes thrice as long
        yield TraceArrays(
            trace.id,
            trace.step_s,
            states.stop - states.start,
            dict(objects),
            spans[items],
            **parts,
            texts=trace.texts,
            ends=trace.ends,
            told=trace.told,
            faults=trace.faults,
        )


def _columns(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """The whole columns, of all traces that share them."""
    return values.columns if type(values) is SharedColumns else values


def _places(trace: TraceArrays) -> tuple[int, int, int]:
    """Where a trace's states, cells and objects begin in its columns."""
    values, objects = trace.world, trace.only
    at = (values.states.start, values.cells.start) if type(values) is SharedColumns else (0, 0)
    return *at, objects.states.start if type(objects) is SharedColumns else 0


def _at(column: Any, places: NDArray[np.intp]) -> Any:
    if isinstance(column, tuple):
        return tuple([own.take(places) for own in column])
    return column.take(places)


def _slices(sizes: NDArray[np.intp]) -> list[slice]:
    ends = sizes.cumsum().tolist()
    return list(map(slice, [0, *ends[:-1]], ends))


def starts_of(spans: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where the values about each object begin, and where those about the last end."""
    lengths = spans[:, 1] - spans[:, 0] + 1
    return np.concatenate([np.zeros(1, dtype=np.intp), lengths.cumsum()])


_NOTHING = object()
"""Stands for a value that is not given."""
