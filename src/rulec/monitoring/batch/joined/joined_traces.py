"""Traces of one kind end to end; those whose columns lie in the same arrays are joined."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.trace import Trace
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_arrays import BY_NAME, TraceArrays, by_name
from rulec.trace.trace_columns import Array
from rulec.trace.trace_model import Ending
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class JoinedPiece:
    """The content of one trace, or of several whose columns lie in the same arrays.

    ``between`` has values about ``pairs`` of objects (pairs x 2, numbers among all of the traces):
    pair by pair, one for each state in which both are present.
    """

    world: Mapping[str, Array]
    about: Mapping[str, Array]
    unknown: Mapping[str, Flags]
    absent: Mapping[str, Flags]
    bounds: Mapping[str, tuple[Array, Array]]
    only: Mapping[str, Flags]
    texts: Mapping[str, tuple[str, ...]]
    n_objects: int
    between: Mapping[str, Array] = field(default_factory=dict)
    pairs: Indices = field(default_factory=lambda: np.empty((0, 2), dtype=np.intp))

    @staticmethod
    def of(traces: Sequence[TraceArrays]) -> JoinedPiece:
        """The content of traces, each of which lies before the next one."""
        first, last = traces[0], traces[-1]
        ends = zip(BY_NAME, by_name(first), by_name(last), strict=True)
        columns: dict[str, Any] = {name: _joined(own, end) for name, own, end in ends}
        n_objects = sum([len(trace.objects) for trace in traces])
        return JoinedPiece(**columns, texts=first.texts, n_objects=n_objects)


class TraceKind(NamedTuple):
    """What must be the same for traces to be judged together; as in a ``Trace``."""

    step_s: float
    ends: Ending
    told: frozenset[str] | None

    @property
    def is_whole(self) -> bool:
        """Whether nothing is unknown before, after and beside the traces."""
        return self.ends == "complete" and self.told is None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JoinedTraces:
    """Traces of one kind with the same names, in the order of their ``pieces``.

    ``lengths`` and ``n_objects`` are each trace's numbers of states and of objects; ``types``,
    ``names`` and ``spans`` (objects x 2: first and last state in the trace) are of all objects.
    ``id_of`` gives the id of the trace of a number, ``says`` whether a state of it has a name, and
    ``trace`` the trace, with what follows from its values by facts; the columns have this, too, if
    they are ``derived``.
    """

    kind: TraceKind
    lengths: Indices
    n_objects: Sequence[int]
    spans: Indices
    types: Sequence[str]
    names: Sequence[str]
    pieces: Sequence[JoinedPiece]
    id_of: Callable[[int], str]
    says: Callable[[int, str], bool]
    trace: Callable[[int], Trace]
    derived: bool

    def objects_of(self, number: int) -> Mapping[str, str]:
        """The objects of the trace of a number, with their types."""
        begin = sum(self.n_objects[:number])
        own = slice(begin, begin + self.n_objects[number])
        return dict(zip(self.names[own], self.types[own], strict=True))

    @staticmethod
    def of_arrays(traces: Sequence[TraceArrays], vocabulary: Vocabulary) -> JoinedTraces:
        """Traces in arrays, which are of one kind."""
        example = traces[0]
        return JoinedTraces(
            kind=TraceKind(example.step_s, example.ends, example.told),
            lengths=np.array([trace.n_states for trace in traces], dtype=np.intp),
            n_objects=[len(trace.objects) for trace in traces],
            spans=np.concatenate([trace.spans for trace in traces]),
            types=[kind for trace in traces for kind in trace.objects.values()],
            names=[name for trace in traces for name in trace.objects],
            pieces=tuple(_joined_pieces(traces)),
            id_of=lambda number: traces[number].id,
            says=lambda number, name: traces[number].says(name),
            trace=lambda number: with_all_values(traces[number].trace(), vocabulary),
            derived=not vocabulary.implied,
        )


def with_all_values(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace with what follows from its values by facts. Raises RulecError R0503."""
    return with_derived_values(spelled_out(trace, vocabulary), vocabulary)


def side_by_side(traces: Sequence[TraceArrays]) -> list[int]:
    """The places of traces, sorted so that those in the same arrays follow each other."""
    known: dict[int, int] = {}

    def place(number: int) -> tuple[int, int]:
        own = traces[number].world
        if not isinstance(own, SharedColumns):
            return len(traces) + number, 0
        return known.setdefault(id(own.columns), len(known)), own.states.start

    return sorted(range(len(traces)), key=place)


def _joined_pieces(traces: Sequence[TraceArrays]) -> Iterator[JoinedPiece]:
    """The content of the traces, joined where they lie in the same arrays."""
    begin = 0
    for place, (trace, other) in enumerate(pairwise(traces), 1):
        if not _stands_before(trace, other):
            yield JoinedPiece.of(traces[begin:place])
            begin = place
    yield JoinedPiece.of(traces[begin:])


def _stands_before(before: TraceArrays, after: TraceArrays) -> bool:
    """Whether all columns of a trace lie before those of another in the same arrays."""
    if after.texts is not before.texts:
        return False
    for own, theirs in zip(by_name(before), by_name(after), strict=True):
        if type(own) is SharedColumns:
            if not own.is_before(theirs):
                return False
        elif own or theirs or type(own) is not type(theirs):
            return False
    return True


def _joined(own: Mapping[str, Any], end: Mapping[str, Any]) -> Mapping[str, Any]:
    if isinstance(own, SharedColumns) and isinstance(end, SharedColumns):
        return own.up_to(end)
    return own
