"""The content of traces in arrays; traces whose columns lie in the same arrays are joined."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import attrgetter
from typing import Any

from rulec.array_types import Flags
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_columns import Array

_COLUMNS = ("world", "about", "unknown", "absent", "bounds", "only")
_columns_of = attrgetter(*_COLUMNS)


@dataclass(frozen=True, slots=True)
class JoinedTraces:
    """The content of one trace, or of several whose columns lie in the same arrays."""

    world: Mapping[str, Array]
    about: Mapping[str, Array]
    unknown: Mapping[str, Flags]
    absent: Mapping[str, Flags]
    bounds: Mapping[str, tuple[Array, Array]]
    only: Mapping[str, Flags]
    texts: Mapping[str, tuple[str, ...]]
    n_objects: int

    @staticmethod
    def of(traces: Sequence[TraceArrays]) -> JoinedTraces:
        """The content of traces, each of which lies before the next one."""
        first, last = traces[0], traces[-1]
        ends = zip(_COLUMNS, _columns_of(first), _columns_of(last), strict=True)
        columns: dict[str, Any] = {name: _joined(own, end) for name, own, end in ends}
        n_objects = sum([len(trace.objects) for trace in traces])
        return JoinedTraces(**columns, texts=first.texts, n_objects=n_objects)


def side_by_side(traces: Sequence[TraceArrays]) -> list[int]:
    """The places of traces, sorted so that those in the same arrays follow each other."""
    known: dict[int, int] = {}

    def place(number: int) -> tuple[int, int]:
        own = traces[number].world
        if not isinstance(own, SharedColumns):
            return len(traces) + number, 0
        return known.setdefault(id(own.columns), len(known)), own.states.start

    return sorted(range(len(traces)), key=place)


def joined_traces(traces: Sequence[TraceArrays]) -> Iterator[JoinedTraces]:
    """The content of the traces, joined where they lie in the same arrays."""
    begin = 0
    for place, (trace, other) in enumerate(pairwise(traces), 1):
        if not _stands_before(trace, other):
            yield JoinedTraces.of(traces[begin:place])
            begin = place
    yield JoinedTraces.of(traces[begin:])


def _stands_before(before: TraceArrays, after: TraceArrays) -> bool:
    """Whether all columns of a trace lie before those of another in the same arrays."""
    if after.texts is not before.texts:
        return False
    for own, theirs in zip(_columns_of(before), _columns_of(after), strict=True):
        if isinstance(own, SharedColumns):
            if not own.is_before(theirs):
                return False
        elif own or theirs or type(own) is not type(theirs):
            return False
    return True


def _joined(own: Mapping[str, Any], end: Mapping[str, Any]) -> Mapping[str, Any]:
    if isinstance(own, SharedColumns) and isinstance(end, SharedColumns):
        return own.up_to(end)
    return own
