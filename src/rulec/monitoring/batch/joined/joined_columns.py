"""Traces of one shape, given as columns, laid end to end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain, product
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.alike_traces import AlikeTraces
from rulec.monitoring.batch.columns.encoded_columns import PartlyKnown, UnencodableError
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, TraceKind
from rulec.monitoring.batch.joined.piece_columns import PieceColumns
from rulec.trace.trace_arrays import starts_of
from rulec.trace.trace_columns import Array, Key, Layout, TraceColumns
from rulec.vocabulary import Vocabulary

_Items: TypeAlias = tuple[str, ...]

_Stretch: TypeAlias = tuple[int, int | None]
"""The first and the last state in which objects are present, in all traces; None for its end."""


def joined_columns(alike: AlikeTraces, vocabulary: Vocabulary) -> JoinedTraces:
    """Traces of one shape, in the order of their columns.

    Raises UnencodableError if a value about two objects is missing, or one about more is there.
    """
    own, layout = alike.columns, alike.columns.layout
    n_traces, objects = layout.n_traces, list(own.objects)
    _check_pairs(own, vocabulary)
    of_each: dict[_Items, _Stretch] = {(x,): own.present.get(x, (0, None)) for x in objects}
    numbers = {item: number for number, item in enumerate(objects)}
    said = {items for _, items in own.values if len(items) == 2}
    pairs = sorted((numbers[first], numbers[second]) for first, second in said)
    of_pairs: dict[_Items, _Stretch] = {}
    for x, y in pairs:
        stretch = _both(own, objects[x], objects[y])
        if stretch is not None:
            of_pairs[objects[x], objects[y]] = stretch
    of_world: dict[_Items, _Stretch] = {(): (0, None)}
    places_by_arity = [
        _GroupPlaces.of(stretches, layout) for stretches in (of_world, of_each, of_pairs)
    ]
    columns = PieceColumns()
    for name in dict.fromkeys(name for name, _ in own.values):
        declaration = vocabulary.declarations[name]
        arity = len(declaration.parameters)
        places = places_by_arity[arity]
        given = [items for items in places.groups if (name, items) in own.values]
        if not given:
            continue  # about two that never meet
        suits = absent = None
        if arity == 1:
            suits = np.tile([items in given for items in places.groups], n_traces)
        elif arity == 2 and len(given) < len(places.groups) and declaration.default is not None:
            absent = places.without(given)
        columns.add_encoded(places.column(own, name, given), declaration, suits, absent)
    begins = len(objects) * np.arange(n_traces)[:, None, None]
    met = [(numbers[first], numbers[second]) for first, second in of_pairs]
    chosen = np.array(met, dtype=np.intp).reshape(1, -1, 2) + begins
    return JoinedTraces(
        kind=TraceKind(own.step_s, alike.ends, None),
        lengths=layout.lengths.astype(np.intp),
        n_objects=[len(objects)] * n_traces,
        spans=places_by_arity[1].spans,
        types=[*own.objects.values()] * n_traces,
        names=list(chain.from_iterable(map(alike.names, range(n_traces)))),
        pieces=(columns.piece(len(objects) * n_traces, chosen.reshape(-1, 2)),),
        trace=alike.traces,
        derived=True,
    )


def _both(columns: TraceColumns, first: str, second: str) -> _Stretch | None:
    """When two objects are both present; None if they never are."""
    since, until = zip(*[columns.present.get(x, (0, None)) for x in (first, second)], strict=True)
    ends = [end for end in until if end is not None]
    begin, end = max(since), min(ends, default=None)
    return None if end is not None and end < begin else (begin, end)


def _check_pairs(columns: TraceColumns, vocabulary: Vocabulary) -> None:
    """Raise UnencodableError if a value about a pair is missing, or one about more is there."""
    if any(len(items) > 2 for _, items in columns.values):
        raise UnencodableError
    for name in {name for name, items in columns.values if len(items) == 2}:
        declaration = vocabulary.declarations[name]
        if declaration.default is not None:
            continue
        fitting = [
            [item for item, own in columns.objects.items() if vocabulary.is_subtype(own, kind)]
            for kind in declaration.parameters
        ]
        for first, second in product(*fitting):
            is_said = first == second or (name, (first, second)) in columns.values
            if not is_said and _both(columns, first, second) is not None:
                raise UnencodableError


class _GroupPlaces(NamedTuple):
    """The places of values about some ``groups`` of objects: trace by trace, group by group.

    ``spans`` are the first and last state of each; ``places`` has for each value its place in
    columns that are laid out step by step, ``of_groups`` which values are about each group.
    """

    groups: Sequence[_Items]
    spans: Indices
    places: Indices
    of_groups: Sequence[Indices]

    @staticmethod
    def of(stretches: Mapping[_Items, _Stretch], layout: Layout) -> _GroupPlaces:
        """The places for groups that are present in these stretches."""
        n_traces, n_groups = layout.n_traces, len(stretches)
        of_traces: Any = np.empty((n_traces, n_groups, 2), dtype=np.intp)
        for number, (first, last) in enumerate(stretches.values()):
            of_traces[:, number, 0] = first
            of_traces[:, number, 1] = layout.lengths - 1 if last is None else last
        spans: Indices = of_traces.reshape(-1, 2)
        starts = starts_of(spans)
        lengths = starts[1:] - starts[:-1]
        steps = np.arange(starts[-1]) + (spans[:, 0] - starts[:-1]).repeat(lengths)
        traces = np.arange(n_traces).repeat(n_groups).repeat(lengths)
        group_of = np.tile(np.arange(n_groups), n_traces).repeat(lengths)
        of_groups = [(group_of == number).nonzero()[0] for number in range(n_groups)]
        return _GroupPlaces(list(stretches), spans, layout.starts[steps] + traces, of_groups)

    def column(self, columns: TraceColumns, name: str, given: Sequence[_Items]) -> PartlyKnown:
        """A name's values about the groups that it is given for."""
        keys = {self.groups.index(items): (name, items) for items in given}
        values = self._merged(keys, columns.values)
        upper = unknown = None
        if any(key in columns.upper for key in keys.values()):
            upper = self._merged(keys, {**columns.values, **columns.upper})
        dark = {number: key for number, key in keys.items() if key in columns.unknown}
        if dark:
            unknown = self._merged(dark, columns.unknown)
        return PartlyKnown(values, upper, unknown)

    def without(self, given: Sequence[_Items]) -> Flags:
        """The values that are not about these groups."""
        others: Flags = np.ones(len(self.places), dtype=bool)
        for items in given:
            others[self.of_groups[self.groups.index(items)]] = False
        return others

    def _merged(self, keys: Mapping[int, Key], columns: Mapping[Key, Array]) -> Array:
        """One column for all groups, of the columns of some."""
        if len(self.groups) == 1:
            (key,) = keys.values()
            return columns[key].take(self.places)
        merged: Array = np.zeros(len(self.places), dtype=_dtype(columns[x] for x in keys.values()))
        for number, key in keys.items():
            own = self.of_groups[number]
            merged[own] = columns[key].take(self.places[own])
        return merged


def _dtype(columns: Iterable[Array]) -> np.dtype[Any]:
    return np.result_type(*columns)
