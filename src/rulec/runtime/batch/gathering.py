"""States gathered into columns, as far as nothing about them is odd."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rulec.trace.columns import Array, Key, TraceCells, TraceColumns, smallest_unsigned
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary

_NOT_GIVEN = object()
_EXACT_IN_FLOATS = 1 << 53
_EMPTY: Mapping[str, Any] = {}


class OddError(Exception):
    """Some state does not fit the vocabulary, or leaves out what has no default."""


def gathered(traces: TraceCells, vocabulary: Vocabulary) -> TraceColumns:
    """The same traces as columns.

    Raises:
        OddError: if ``check_state`` would refuse a state, or a value is given in some states only
            and has no default; sometimes, too, if a value is of an unusual type.
    """
    if not set(map(type, traces.states)) <= {dict}:
        raise OddError
    gathering = _Gathering(traces, vocabulary)
    for name in set().union(*traces.states):
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise OddError
        values = [state.get(name, _NOT_GIVEN) for state in traces.states]
        gathering.add(values, declaration, declaration.parameters, ())
    return TraceColumns(
        traces.layout, gathering.columns, traces.objects, traces.present, traces.step_s
    )


class _Gathering:
    def __init__(self, traces: TraceCells, vocabulary: Vocabulary) -> None:
        self.columns: dict[Key, Array] = {}
        self._traces = traces
        self._vocabulary = vocabulary

    def add(
        self,
        values: Sequence[Any],
        declaration: Declaration,
        parameters: Sequence[str],
        items: tuple[str, ...],
    ) -> None:
        """Add the columns for what states say of a name about some objects, and of further ones."""
        if not parameters:
            self.columns[declaration.name, items] = self._column(values, declaration, items)
            return
        maps = [_EMPTY if value is _NOT_GIVEN else value for value in values]
        if not set(map(type, maps)) <= {dict}:
            raise OddError
        for item in set().union(*maps):
            kind = self._traces.objects.get(item)
            if kind is None or not self._vocabulary.is_subtype(kind, parameters[0]):
                raise OddError
            inner = [one.get(item, _NOT_GIVEN) for one in maps]
            self.add(inner, declaration, parameters[1:], (*items, item))

    def _column(
        self, values: Sequence[Any], declaration: Declaration, items: tuple[str, ...]
    ) -> Array:
        if _NOT_GIVEN in values:
            values = self._filled(values, declaration, items)
        kinds = set(map(type, values))
        if isinstance(declaration, Enumeration):
            places = {value: place for place, value in enumerate(declaration.values)}
            if kinds != {str} or not places.keys() >= set(values):
                raise OddError
            dtype = smallest_unsigned(len(places))
            distinct = np.fromiter(map(places.__getitem__, values), dtype, len(values))
        elif isinstance(declaration, Signal):
            if kinds != {bool}:
                raise OddError
            distinct = np.array(values, dtype=bool)
        else:
            if not kinds <= {int, float}:
                raise OddError
            whole = [value for value in values if type(value) is int] if int in kinds else []
            if any(abs(value) > _EXACT_IN_FLOATS for value in whole):
                raise OddError
            distinct = np.array(values, dtype=np.float64)
            if not np.isfinite(distinct).all():
                raise OddError
        return distinct.take(self._traces.cells)

    def _filled(
        self, values: Sequence[Any], declaration: Declaration, items: tuple[str, ...]
    ) -> Sequence[Any]:
        """The values with the default where none is given."""
        filler = declaration.default
        if filler is None:
            if not all(self._is_needless(cell, items) for cell in _places(values)):
                raise OddError
            # Where an object is not there, nothing reads what would be said of it.
            filler = next(value for value in values if value is not _NOT_GIVEN)
        return [filler if value is _NOT_GIVEN else value for value in values]

    def _is_needless(self, cell: int, items: tuple[str, ...]) -> bool:
        there = self._traces.there
        return bool(there) and not all(item in there[cell] for item in items)


def _places(values: Sequence[Any]) -> list[int]:
    return [place for place, value in enumerate(values) if value is _NOT_GIVEN]
