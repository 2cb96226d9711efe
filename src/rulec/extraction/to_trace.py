"""A drive as a trace of the signals that a vocabulary declares."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from math import hypot
from typing import Any, NamedTuple

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.clearance_signals import clearance_signals
from rulec.extraction.signals.ego_signals import ego_signals
from rulec.extraction.signals.flow_signals import flow_signals
from rulec.extraction.signals.following_signals import following_signals
from rulec.extraction.signals.intention_signals import intention_signals
from rulec.extraction.signals.lane_signals import lane_change_signals, lane_mark_signals
from rulec.extraction.signals.map.crossing_signals import crossing_signals
from rulec.extraction.signals.map.junction_signals import junction_signals
from rulec.extraction.signals.map.map_signals import map_signals
from rulec.extraction.signals.map.priority_signals import priority_signals
from rulec.extraction.signals.map.road_signals import road_signals
from rulec.extraction.signals.map.roundabout_signals import roundabout_signals
from rulec.extraction.signals.map.zone_signals import zone_signals
from rulec.extraction.signals.measured_numbers import safe_distance_error
from rulec.extraction.signals.merge_signals import merge_signals
from rulec.extraction.signals.participant_signals import (
    gap_beside_safe_distance,
    participant_signals,
)
from rulec.extraction.signals.settling import settled
from rulec.extraction.signals.signal_columns import Bounds, SignalColumn, SignalColumns
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.extraction.traffic_thresholds import LEAST_S
from rulec.logic.formula import Relation
from rulec.monitoring.explain.margins import Margin
from rulec.partition.cell_graph import PAPER_SURFACE
from rulec.trace import State, Trace, Value
from rulec.trace.vocabulary_projection import fits, is_about, known_type, known_types
from rulec.value_display import short_repr
from rulec.vocabulary import Declaration, Enumeration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval


@dataclass(frozen=True, slots=True)
class Presence:
    """An object of a trace: a participant's row, first and last column of its presence."""

    name: str
    row: int
    first: int
    last: int


def presences(context: DriveContext) -> Iterator[Presence]:
    """The contiguous presences of all participants; absences up to ``away_s`` are bridged.

    Those in which a participant is not beside the road never are: its extents are not known then.
    """
    longest = round(context.thresholds.away_s / context.recording.step_s)
    participants = context.tracks.participants
    taken = {body.id for body in participants}
    unknown = np.cumsum(np.isnan(context.extents.s), axis=1)
    for row, body in enumerate(participants):
        columns = np.flatnonzero(context.relevant[row])
        gone = unknown[row]
        breaks = [
            k
            for k in range(1, len(columns))
            if columns[k] - columns[k - 1] > longest + 1 or gone[columns[k]] > gone[columns[k - 1]]
        ]
        # Who is in sight only, too far away to count, is no object
        parts = np.split(columns, breaks) if len(columns) else []
        for number, part in enumerate(parts, 1):
            name = body.id
            if number > 1:
                name = next(free for k in count(2) if (free := f"{body.id}_{k}") not in taken)
                taken.add(name)
            yield Presence(name, row, int(part[0]), int(part[-1]))


_SIGNALS: tuple[Callable[[DriveContext], SignalColumns], ...] = (
    ego_signals,
    participant_signals,
    following_signals,
    map_signals,
    road_signals,
    junction_signals,
    priority_signals,
    crossing_signals,
    roundabout_signals,
    zone_signals,
    intention_signals,
    merge_signals,
    clearance_signals,
    flow_signals,
    lane_change_signals,
    lane_mark_signals,
)
"""The signal passes, in the order in which traces name their signals."""

_KINDS: Mapping[str, type] = {"b": bool, "f": float, "i": float}


@dataclass(frozen=True, slots=True, eq=False)
class DecidedBy:
    """The numbers by which a signal about objects was decided: whether a value reaches a limit.

    ``quantity`` is the value's, ``rows`` are the objects' in the arrays, by state; NaN where
    nothing was compared. The errors of values and limits are independent.
    """

    quantity: str
    unit: str
    rows: Mapping[str, int]
    values: Floats
    limits: Floats
    value_error: float
    limit_errors: Floats

    def margin(self, item: str, state: int) -> Margin | None:
        """The margin for an object in a state, if there is one."""
        row = self.rows.get(item)
        if row is None or np.isnan(self.values[row, state]):
            return None
        value, limit = float(self.values[row, state]), float(self.limits[row, state])
        relation: Relation = ">=" if value >= limit else "<"
        limit_error = float(self.limit_errors[row, state])
        return Margin(
            f"{self.quantity}({item})",
            value=value,
            relation=relation,
            limit=limit,
            unit=self.unit,
            value_error=self.value_error,
            limit_error=limit_error,
            error=hypot(self.value_error, limit_error),
        )


class Place(NamedTuple):
    """A place in the recording's coordinates (m), and the lanelet of ego's lane there."""

    x: float
    y: float
    lanelet: str


@dataclass(frozen=True, slots=True)
class Drive:
    """A drive of ``ego`` as a trace from ``start_s`` (s of the recording) on.

    ``kinds`` are the Python types of the signals that the recording supplies, whether or not any
    object is there to have them; ``decided_by`` has the numbers behind Boolean ones. ``places`` are
    where ego's middle is in each state.
    """

    __repr__ = short_repr

    ego: str
    start_s: float
    trace: Trace
    kinds: Mapping[str, type]
    decided_by: Mapping[str, DecidedBy] = field(default_factory=dict, compare=False)
    places: tuple[Place, ...] = field(default=(), compare=False)

    @property
    def words(self) -> frozenset[str]:
        """The names of the signals that the recording supplies."""
        return frozenset(self.kinds)

    def time_s(self, state: int | None) -> float:
        """The time of a state (s of the recording), None being the last state."""
        number = len(self.trace.states) - 1 if state is None else state
        return round(self.start_s + number * self.trace.step_s, 9)


@dataclass(frozen=True, slots=True)
class TraceWriter:
    """The choice of signals to write: a vocabulary's, optionally only ``names``.

    ``assumed`` are values that hold in every state, whatever the recording says. With ``defaults``
    what is unknown is left out, so that it takes its default, and the trace is over when it ends.
    """

    vocabulary: Vocabulary | None = None
    names: frozenset[str] | None = None
    assumed: Mapping[str, Value] = field(default_factory=dict)
    defaults: bool = False


ALL_SIGNALS = TraceWriter()


def to_trace(context: DriveContext, ego: str, name: str, writer: TraceWriter) -> Drive:
    """The drive of ``ego`` as a trace called ``name``."""
    signals = SignalColumns()
    for signals_of in _SIGNALS:
        signals |= signals_of(context)
    signals = settled(signals, LEAST_S, context.recording.step_s)
    types = [body.object_types for body in context.tracks.participants]
    if writer.vocabulary is not None:
        signals = _projected(signals, types, writer.vocabulary, writer.names)
    signals = _with_assumed(signals, writer.assumed, context.states)
    if writer.defaults and writer.vocabulary is not None:
        signals = _with_likeliest(signals, writer.vocabulary)
    present = list(presences(context))
    own_types = {presence.name: types[presence.row] for presence in present}
    if writer.vocabulary is None:
        objects = {object_name: own[0] for object_name, own in own_types.items()}
    else:
        objects = known_types(own_types, writer.vocabulary)
    present = [presence for presence in present if presence.name in objects]
    spans = {presence.name: (presence.first, presence.last) for presence in present}
    whole = (0, context.states - 1)
    trace = Trace(
        name,
        context.recording.step_s,
        objects,
        _states(signals, present, context.states, defaults=writer.defaults),
        {object_name: span for object_name, span in spans.items() if span != whole},
        ends="complete" if writer.defaults else "cut",
        told=None if writer.defaults else frozenset((*signals.world, *signals.about)),
    )
    start_s = round(context.first_step * context.recording.step_s, 9)
    columns = {**signals.world, **signals.about}
    kinds = {name: _KINDS.get(column.dtype.kind, str) for name, column in columns.items()}
    decided_by = {}
    if "safe_gap" in signals.about:
        rows = {presence.name: presence.row for presence in present}
        gap, safe = gap_beside_safe_distance(context)
        errors = context.tolerances.place_m, safe_distance_error(context)
        decided_by["safe_gap"] = DecidedBy("gap", "m", rows, gap, safe, *errors)
    places = tuple(_places(context))
    return Drive(ego, start_s, trace, kinds, decided_by=decided_by, places=places)


def _with_assumed(
    signals: SignalColumns, assumed: Mapping[str, Value], states: int
) -> SignalColumns:
    values = {name: np.full(states, value) for name, value in assumed.items()}
    unknown = {name: rows for name, rows in signals.unknown.items() if name not in assumed}
    bounds = {name: rows for name, rows in signals.bounds.items() if name not in assumed}
    return replace(signals, world={**signals.world, **values}, unknown=unknown, bounds=bounds)


def _with_likeliest(signals: SignalColumns, vocabulary: Vocabulary) -> SignalColumns:
    """The signals with measured values for what is unknown and has no default."""
    declared = vocabulary.declarations
    unknown = {
        name: rows
        for name, rows in signals.unknown.items()
        if name not in declared or declared[name].default is not None
    }
    return replace(signals, unknown=unknown)


def _places(context: DriveContext) -> Iterator[Place]:
    pieces = context.road.piece(context.ego_extents.s[0]).tolist()
    lanes = context.ego_lane.tolist()
    rows = zip(context.ego.x[0].tolist(), context.ego.y[0].tolist(), pieces, lanes, strict=True)
    for x, y, piece, lane in rows:
        yield Place(round(x, 2), round(y, 2), context.road.lanelet(piece, lane).id)


def _projected(
    signals: SignalColumns,
    types: Sequence[Sequence[str]],
    vocabulary: Vocabulary,
    names: frozenset[str] | None,
) -> SignalColumns:
    """The signals that a vocabulary declares, optionally only those in ``names``.

    ``types`` are those of the objects, a row each, the most specific first.
    """
    own_types = [known_type(row, vocabulary) for row in types]
    world, about, only = {}, {}, dict(signals.only)
    for name, declaration in vocabulary.declarations.items():
        if names is not None and name not in names:
            continue
        if name in signals.world and not declaration.parameters:
            column = _in_paper_words(name, signals.world[name], declaration)
            if _fits(name, column, signals.unknown.get(name), declaration):
                world[name] = column
        if name in signals.about and len(declaration.parameters) == 1:
            column = signals.about[name]
            if _fits(name, column, signals.unknown.get(name), declaration):
                about[name] = column
                suits = [is_about(declaration, own, vocabulary) for own in own_types]
                only[name] = np.array(suits, dtype=bool) & only.get(name, True)
    return replace(signals, world=world, about=about, only=only)


def _in_paper_words(name: str, column: SignalColumn, declaration: Declaration) -> SignalColumn:
    """Surfaces in the paper's two words, for vocabularies with only those."""
    if name != "surface" or not isinstance(declaration, Enumeration):
        return column
    if not set(PAPER_SURFACE.values()).issuperset(declaration.values):
        return column
    return np.array([PAPER_SURFACE.get(surface, "R_cw") for surface in column.tolist()])


def _fits(name: str, column: SignalColumn, unknown: Flags | None, declaration: Declaration) -> bool:
    """Whether all values of a column that are known are a declaration's."""
    # All floats are alike; the distinct values of others are few
    if column.dtype.kind == "f":
        return fits(name, column.ravel()[:1].tolist(), declaration)
    known = column if unknown is None or unknown.all() else column[~unknown]
    return fits(name, np.unique(known).tolist(), declaration)


def _states(
    signals: SignalColumns, present: Sequence[Presence], count: int, *, defaults: bool
) -> tuple[State, ...]:
    states: list[dict[str, Any]] = [{} for _ in range(count)]
    known_bounds = {} if defaults else signals.bounds
    for name, column in signals.world.items():
        unknown, bounds = signals.unknown.get(name), known_bounds.get(name)
        for state, value in enumerate(_values(column, bounds, ())):
            if unknown is None or not unknown[state]:
                states[state][name] = value
            elif not defaults:
                states[state][name] = UNKNOWN
    for name, rows in signals.about.items():
        only, unknown = signals.only.get(name), signals.unknown.get(name)
        bounds = known_bounds.get(name)
        by_state: list[dict[str, Any]] = [{} for _ in range(count)]
        for presence in present:
            if only is None or only[presence.row]:
                span = range(presence.first, presence.last + 1)
                values = _values(rows, bounds, (presence.row, span))
                for state, value in zip(span, values, strict=True):
                    if unknown is None or not unknown[presence.row, state]:
                        by_state[state][presence.name] = value
                    elif not defaults:
                        by_state[state][presence.name] = UNKNOWN
        for state, of_objects in enumerate(by_state):
            if of_objects:
                states[state][name] = of_objects
    return tuple(states)


def _values(column: SignalColumn, bounds: Bounds | None, part: Any) -> list[Any]:
    """The values in a part of a column; intervals where bounds are apart."""
    if bounds is None:
        values: list[Any] = column[part].tolist()
        return values
    low, high = bounds
    ends = zip(low[part].tolist(), high[part].tolist(), strict=True)
    return [first if first == last else Interval(first, last) for first, last in ends]
