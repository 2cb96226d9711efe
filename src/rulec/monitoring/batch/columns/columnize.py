"""Columns built from states, unless a state is irregular."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from contextlib import suppress
from itertools import count, repeat
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.state_validation import NUMBERS, TRUTHS
from rulec.trace.trace_columns import Array, Key, TraceCells, TraceColumns, smallest_unsigned
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, UnknownValue
from rulec.vocabulary.vocabulary_model import least_value, values_of

if TYPE_CHECKING:
    from rulec.monitoring.batch.trace_groups import Names

_NOT_GIVEN = object()
_EMPTY: Mapping[str, Any] = {}


class UnencodableError(Exception):
    """A state has an invalid, missing or unusual value."""


def columnize(
    traces: TraceCells, vocabulary: Vocabulary, names: Sequence[Names] = ()
) -> TraceColumns:
    """Turn traces that are given as cells into columns.

    ``names`` gives for each state the names of the objects in it, if they differ from their own.

    Raises UnencodableError if ``check_state`` would refuse a state, or if a value without default
    is given in some states only; in some cases also for a value of an unusual type.
    """
    if not set(map(type, traces.states)) <= {dict}:
        raise UnencodableError
    columnizer = _Columnizer(traces, vocabulary, names)
    for name in set().union(*traces.states):
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise UnencodableError
        values = [state.get(name, _NOT_GIVEN) for state in traces.states]
        columnizer.add(values, declaration, declaration.parameters, ())
    return TraceColumns(
        traces.layout,
        columnizer.columns,
        traces.objects,
        traces.present,
        traces.step_s,
        unknown=columnizer.unknown,
        upper=columnizer.upper,
    )


class _Columnizer:
    def __init__(self, traces: TraceCells, vocabulary: Vocabulary, names: Sequence[Names]) -> None:
        self.columns: dict[Key, Array] = {}
        self.unknown: dict[Key, NDArray[np.bool_]] = {}
        self.upper: dict[Key, NDArray[np.float64]] = {}
        self._names = names
        self._traces = traces
        self._vocabulary = vocabulary
        self._known: dict[str, Set[int]] = {}

    def add(
        self,
        values: Sequence[Any],
        declaration: Declaration,
        parameters: Sequence[str],
        items: tuple[str, ...],
    ) -> None:
        """Add the columns of a name, for some objects and for further ones."""
        if not parameters:
            self._add_column(values, declaration, items)
            return
        if UNKNOWN in values:
            values = list(map(self._of_each, values, count(), repeat(parameters[0])))
        maps = [_EMPTY if value is _NOT_GIVEN else value for value in values]
        if not set(map(type, maps)) <= {dict}:
            raise UnencodableError
        for item, inner in self._by_object(maps):
            kind = self._traces.objects.get(item)
            if kind is None or not self._vocabulary.is_subtype(kind, parameters[0]):
                raise UnencodableError
            self.add(inner, declaration, parameters[1:], (*items, item))

    def _by_object(self, maps: Sequence[Mapping[str, Any]]) -> Sequence[tuple[str, Sequence[Any]]]:
        if set(map(len, maps)) == {len(maps[0])}:
            with suppress(KeyError, ValueError):
                return self._if_of_the_same(maps)
        if self._names:
            objects = self._traces.objects
            renaming = {own: dict(zip(own, objects, strict=True)) for own in set(self._names)}
            maps = list(map(_under, maps, map(renaming.__getitem__, self._names)))
        every = set().union(*maps)
        return [(item, [map_.get(item, _NOT_GIVEN) for map_ in maps]) for item in every]

    def _if_of_the_same(
        self, maps: Sequence[Mapping[str, Any]]
    ) -> Sequence[tuple[str, Sequence[Any]]]:
        """The values by object, if all states mention the same objects; else raises KeyError.

        Raises ValueError if the first state mentions something that is not an object.
        """
        if not self._names:
            return [(item, list(map(itemgetter(item), maps))) for item in maps[0]]
        objects = tuple(self._traces.objects)
        return [
            (
                objects[place],
                [map_[own[place]] for map_, own in zip(maps, self._names, strict=True)],
            )
            for place in map(self._names[0].index, maps[0])
        ]

    def _of_each(self, value: Any, place: int, kind: str) -> Any:
        """One object's value of a value given for all: unknown for all is unknown for each."""
        if value is not UNKNOWN:
            return value
        objects = self._traces.objects
        names = self._names[place] if self._names else tuple(objects)
        own = zip(names, objects.values(), strict=True)
        return {name: UNKNOWN for name, type_ in own if self._vocabulary.is_subtype(type_, kind)}

    def _add_column(
        self, values: Sequence[Any], declaration: Declaration, items: tuple[str, ...]
    ) -> None:
        if _NOT_GIVEN in values:
            filler: Any = declaration.default
            if filler is None:
                if self._are_there_in_any(items, values):
                    raise UnencodableError
                # Values about an absent object are never read.
                filler = next(value for value in values if value is not _NOT_GIVEN)
            values = [filler if value is _NOT_GIVEN else value for value in values]
        cells, key = self._traces.cells, (declaration.name, items)
        column = encode_partly_known(values, declaration)
        self.columns[key] = column.values.take(cells)
        if column.unknown is not None:
            self.unknown[key] = column.unknown.take(cells)
        if column.upper is not None:
            self.upper[key] = column.upper.take(cells)

    def _are_there_in_any(self, items: tuple[str, ...], values: Sequence[Any]) -> bool:
        places = {place for place, value in enumerate(values) if value is _NOT_GIVEN}
        return not self._traces.there or bool(places.intersection(*map(self._places_of, items)))

    def _places_of(self, item: str) -> Set[int]:
        if item not in self._known:
            there = enumerate(self._traces.there)
            self._known[item] = frozenset([place for place, objects in there if item in objects])
        return self._known[item]


def _under(about: Mapping[str, Any], names: Mapping[str, str]) -> Mapping[str, Any]:
    try:
        return {names[item]: value for item, value in about.items()}
    except KeyError:
        raise UnencodableError from None


def column_dtype(declaration: Declaration) -> np.dtype[Any]:
    """The data type of a name's column: see ``TraceColumns``."""
    if isinstance(declaration, Enumeration):
        return smallest_unsigned(len(declaration.values))
    return np.dtype(bool if isinstance(declaration, Signal) else np.float64)


class PartlyKnown(NamedTuple):
    """A column of values, or of the least ones where ``upper`` has the greatest.

    They mean nothing where they are ``unknown``; None means nowhere.
    """

    values: Array
    upper: Array | None
    unknown: NDArray[np.bool_] | None


def encode_partly_known(values: Sequence[Any], declaration: Declaration) -> PartlyKnown:
    """Encode values, of which some may be unknown or intervals. Raises UnencodableError."""
    kinds = set(map(type, values))
    unknown = upper = None
    if UnknownValue in kinds:
        if Interval not in kinds:
            column, unknown = _with_unknown(values, kinds, declaration)
            return PartlyKnown(column, None, unknown)
        unknown = np.array([value is UNKNOWN for value in values])
        anything = least_value(declaration)
        values = [anything if value is UNKNOWN else value for value in values]
    if Interval in kinds:
        highest = [value.high if type(value) is Interval else value for value in values]
        upper = encode_values(highest, declaration)
        values = [value.low if type(value) is Interval else value for value in values]
    return PartlyKnown(encode_values(values, declaration), upper, unknown)


def _with_unknown(
    values: Sequence[Any], kinds: Set[type], declaration: Declaration
) -> tuple[Array, NDArray[np.bool_]]:
    """Encoded values, and the mask of unknown ones. Raises UnencodableError."""
    if isinstance(declaration, Quantity):
        unknown = np.array([value is UNKNOWN for value in values])
        known = [0.0 if value is UNKNOWN else value for value in values]
        return encode_values(known, declaration), unknown
    own = values_of(declaration)
    if not kinds <= {type(own[0]), UnknownValue}:
        raise UnencodableError
    places: dict[Any, int] = {value: place for place, value in enumerate(own)}
    places[UNKNOWN] = len(own)
    try:
        numbers = np.fromiter(
            map(places.__getitem__, values), smallest_unsigned(len(places)), len(values)
        )
    except KeyError:
        raise UnencodableError from None
    unknown = numbers == len(own)
    numbers[unknown] = 0
    return numbers.astype(column_dtype(declaration)), unknown


def encode_values(values: Sequence[Any], declaration: Declaration) -> Array:
    """Encode values. Raises UnencodableError for invalid values and unusual types."""
    kinds = set(map(type, values))
    if isinstance(declaration, Enumeration):
        places = {value: place for place, value in enumerate(declaration.values)}
        if kinds != {str} or not places.keys() >= set(values):
            raise UnencodableError
        return np.fromiter(map(places.__getitem__, values), column_dtype(declaration), len(values))
    if isinstance(declaration, Signal):
        if kinds != TRUTHS:
            raise UnencodableError
        return np.array(values, dtype=bool)
    if not kinds <= NUMBERS:
        raise UnencodableError
    whole = [value for value in values if type(value) is int] if int in kinds else []
    if any(abs(value) > EXACT_IN_FLOATS for value in whole):
        raise UnencodableError
    numbers = np.array(values, dtype=np.float64)
    if not np.isfinite(numbers).all():
        raise UnencodableError
    return numbers
