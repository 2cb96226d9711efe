"""Traces given by their states, laid end to end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, chain, groupby, pairwise, repeat
from operator import itemgetter
from typing import Any, TypeAlias

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, TraceKind
from rulec.monitoring.batch.joined.piece_columns import NOT_GIVEN, PieceColumns
from rulec.trace import Trace
from rulec.vocabulary import Declaration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN

_ByObject: TypeAlias = Mapping[str, Any]

_NOBODY: _ByObject = {}

_DICTS = {dict}


def joined_states(traces: Sequence[Trace], vocabulary: Vocabulary) -> JoinedTraces:
    """Traces of one kind that have passed ``check_frame``, with what follows from their values.

    Raises UnencodableError if ``check_state`` would refuse a state, for values about more than two
    objects, and in some cases for a value of an unusual type.
    """
    states = list(chain.from_iterable([trace.states for trace in traces]))
    if set(map(type, states)) != {dict}:
        raise UnencodableError
    casts = [_TraceObjects(trace, vocabulary) for trace in traces]
    bounds = list(accumulate([len(trace.states) for trace in traces], initial=0))
    columns = PieceColumns()
    pairs: list[tuple[int, int]] = []
    of_pairs: list[tuple[Declaration, Sequence[Sequence[_ByObject]]]] = []
    suits: dict[str, Flags] = {}
    names = list(set().union(*states))
    for name, given in zip(names, _of_all(states, names), strict=True):
        declaration = vocabulary.declarations.get(name)
        if declaration is None or len(declaration.parameters) > 2:
            raise UnencodableError
        kinds = declaration.parameters
        if not kinds:
            columns.add(given, declaration)
            continue
        kind = kinds[0]
        maps = [
            _by_objects(given[begin:end], cast.fitting(kind))
            for cast, (begin, end) in zip(casts, pairwise(bounds), strict=True)
        ]
        if len(kinds) == 2:
            of_pairs.append((declaration, maps))
            continue
        if kind not in suits:
            own = [item in cast.fitting(kind) for cast in casts for item in cast.trace.objects]
            suits[kind] = np.array(own, dtype=bool)
        columns.add(_about_objects(maps, casts), declaration, suits[kind])
    if of_pairs:
        pairs = _add_pairs(of_pairs, casts, columns)
    example = traces[0]
    n_objects = [len(trace.objects) for trace in traces]
    return JoinedTraces(
        kind=TraceKind(example.step_s, example.ends, example.told),
        lengths=np.array([len(trace.states) for trace in traces], dtype=np.intp),
        n_objects=n_objects,
        spans=_indices([span for cast in casts for span in cast.spans]),
        types=[kind for trace in traces for kind in trace.objects.values()],
        names=[name for trace in traces for name in trace.objects],
        pieces=(columns.piece(sum(n_objects), _indices(pairs)),),
        id_of=lambda number: traces[number].id,
        says=lambda number, name: any(name in state for state in traces[number].states),
        trace=traces.__getitem__,
        derived=True,
    )


def _indices(pairs: Sequence[tuple[int, int]]) -> Indices:
    return np.array(pairs, dtype=np.intp).reshape(-1, 2)


@dataclass(frozen=True, eq=False)
class _TraceObjects:
    """The objects of a trace, and when each is present."""

    trace: Trace
    vocabulary: Vocabulary

    @cached_property
    def spans(self) -> Sequence[tuple[int, int]]:
        """The first and the last state of each object."""
        present, whole = self.trace.present, (0, len(self.trace.states) - 1)
        return [present.get(item, whole) for item in self.trace.objects]

    @cached_property
    def together(self) -> Sequence[tuple[slice, list[str]]]:
        """The objects in their order, by stretches of states in which some are present."""
        objects = zip(self.spans, self.trace.objects, strict=True)
        return [
            (slice(first, last + 1), [item for _, item in own])
            for (first, last), own in groupby(objects, key=itemgetter(0))
        ]

    @cached_property
    def _fitting(self) -> dict[str, frozenset[str]]:
        return {}

    def fitting(self, kind: str) -> frozenset[str]:
        """The objects of a type."""
        if kind not in self._fitting:
            own, is_subtype = self.trace.objects.items(), self.vocabulary.is_subtype
            self._fitting[kind] = frozenset([x for x, of in own if is_subtype(of, kind)])
        return self._fitting[kind]


def _by_object(value: Any, fitting: frozenset[str]) -> _ByObject:
    """What a state says of each object."""
    if type(value) is dict:
        if not fitting.issuperset(value):
            raise UnencodableError
        return value
    if value is NOT_GIVEN:
        return _NOBODY
    if value is UNKNOWN:
        return dict.fromkeys(fitting, UNKNOWN)
    raise UnencodableError


def _of_all(maps: Sequence[Mapping[str, Any]], keys: Sequence[str]) -> Iterable[Sequence[Any]]:
    """For each key what each of these has under it."""
    try:
        if len(keys) > 1 and len(maps):
            return list(zip(*map(itemgetter(*keys), maps), strict=True))
        return [list(map(itemgetter(key), maps)) for key in keys]
    except KeyError:
        return ([own.get(key, NOT_GIVEN) for own in maps] for key in keys)


def _by_objects(values: Sequence[Any], fitting: frozenset[str]) -> Sequence[_ByObject]:
    """What each state says of each object."""
    if set(map(type, values)) == _DICTS and all(map(fitting.issuperset, values)):
        return values
    return list(map(_by_object, values, repeat(fitting)))


def _about_objects(
    maps: Sequence[Sequence[_ByObject]], casts: Sequence[_TraceObjects]
) -> list[Any]:
    """A name's values for each object in each of its states."""
    values: list[Any] = []
    for cast, of_trace in zip(casts, maps, strict=True):
        for states, items in cast.together:
            values += chain.from_iterable(_of_all(of_trace[states], items))
    return values


_OfPairs: TypeAlias = tuple[Declaration, Sequence[Sequence[_ByObject]]]
"""A name about two objects, and what each state of each trace says of first objects."""


def _add_pairs(
    of_pairs: Sequence[_OfPairs], casts: Sequence[_TraceObjects], columns: PieceColumns
) -> list[tuple[int, int]]:
    """Add the columns about pairs of objects, and return these."""
    values: list[list[Any]] = [[] for _ in of_pairs]
    pairs: list[tuple[int, int]] = []
    begin = 0
    for number, cast in enumerate(casts):
        items = list(cast.trace.objects)
        places = {item: place for place, item in enumerate(items)}
        own = [_by_pair(declaration, maps[number], cast) for declaration, maps in of_pairs]
        said = {(places[first], places[second]) for found in own for first, second in found}
        for first, second in sorted(said):
            since = max(cast.spans[first][0], cast.spans[second][0])
            until = min(cast.spans[first][1], cast.spans[second][1])
            if since <= until:
                pairs.append((begin + first, begin + second))
                pair = items[first], items[second]
                for found, column in zip(own, values, strict=True):
                    of_first = found.get(pair) or [_NOBODY] * len(cast.trace.states)
                    column += [x.get(items[second], NOT_GIVEN) for x in of_first[since : until + 1]]
        begin += len(items)
    for (declaration, _), column in zip(of_pairs, values, strict=True):
        columns.add(column, declaration)
    return pairs


def _by_pair(
    declaration: Declaration, maps: Sequence[_ByObject], cast: _TraceObjects
) -> Mapping[tuple[str, str], Sequence[_ByObject]]:
    """For each pair what the states say of its second object, asked of its first one."""
    firsts, seconds = map(cast.fitting, declaration.parameters)
    found: dict[tuple[str, str], Sequence[_ByObject]] = {}
    if declaration.default is None:
        # Where a value is missing, this is to be noticed
        found = {(x, y): () for x in firsts for y in seconds if x != y}
    for first in set().union(*maps):
        of_first = [_by_object(about.get(first, NOT_GIVEN), seconds) for about in maps]
        found |= {(first, second): of_first for second in set().union(*of_first)}
    return found
