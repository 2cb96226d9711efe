"""A drive as a trace of the signals that a vocabulary declares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.presences import presence_cells, presence_names, presence_runs
from rulec.extraction.signals import clearance_signals, ego_signals, flow_signals, lane_mark_signals
from rulec.extraction.signals.conduct import (
    being_overtaken,
    called_signals,
    lamp_signals,
    manoeuvre_signals,
    next_lane_signals,
    oncoming_conflicts,
    overtaking_signals,
    reason_signals,
    turning_conflicts,
)
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from rulec.extraction.signals.conduct.manoeuvre_signals import may_back
from rulec.extraction.signals.ego_lanelets import map_contents, own_lanelets
from rulec.extraction.signals.map import (
    crossing_signals,
    exit_room,
    junction_signals,
    lanes_ahead,
    level_crossing_signals,
    line_signals,
    map_signals,
    merge_signals,
    priority_signals,
    road_signals,
    roundabout_signals,
    zone_signals,
)
from rulec.extraction.signals.participants import (
    following_signals,
    intention_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.signals.participants.following_signals import safe_gaps
from rulec.extraction.signals.settling import agreeing, settled
from rulec.extraction.signals.signal_columns import (
    SignalColumns,
    SignalNames,
    known_only,
    unknown_in,
    unknown_where_unlike,
)
from rulec.extraction.signals.words import WordsByModule
from rulec.extraction.traces.recorded_drive import DecidedBy, Drive, DrivePlaces
from rulec.extraction.traces.signal_arrays import (
    WrittenPresences,
    kinds_of,
    signal_parts,
    with_assumed,
    with_likeliest,
    written,
)
from rulec.extraction.traces.tellable_types import told_types
from rulec.extraction.traffic_thresholds import LEAST_S, thresholds_by
from rulec.monitoring.assumptions import check_assumed
from rulec.monitoring.told_names import with_defaulted
from rulec.trace import Value
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_model import Ending
from rulec.trace.vocabulary_projection import (
    known_type,
    values_lacking,
    with_told_values,
)
from rulec.vocabulary import Vocabulary

_WORDS = WordsByModule(
    (
        ego_signals,
        participant_signals,
        participant_conduct,
        lanes_ahead,
        following_signals,
        map_signals,
        road_signals,
        junction_signals,
        line_signals,
        priority_signals,
        crossing_signals,
        roundabout_signals,
        level_crossing_signals,
        zone_signals,
        exit_room,
        intention_signals,
        called_signals,
        merge_signals,
        clearance_signals,
        next_lane_signals,
        flow_signals,
        overtaking_signals,
        being_overtaken,
        lane_change_signals,
        indicator_signals,
        lane_mark_signals,
        manoeuvre_signals,
        lamp_signals,
        reason_signals,
        turning_conflicts,
        oncoming_conflicts,
    )
)
"""All words, in the order in which traces name them."""


_WITHOUT_DIRECTION = frozenset(
    (
        *("driving_side", "one_way", "road_class", "built_up", "speed", "reversing"),
        *("ego_type", "ego_length", "ego_on_call", "told_to_go", "told_to_stop"),
        *("hazard_lights", "headlamps", "front_fog_lamps", "rear_fog_lamps", "warning_lights"),
        *("night", "raining", "wet", "icy", "visibility", "tunnel"),
    )
)
"""The signals that keep their meaning when ego drives against its road. There, ahead and behind,
left and right differ from the road's."""


@dataclass(frozen=True, slots=True)
class TraceWriter:
    """The choice of signals to write: a vocabulary's, optionally only ``names``.

    ``assumed`` values hold in every state, whatever the recording contains. With ``defaults``
    unknown values are left out, so that they take their defaults, and the trace is complete where
    it ends. ``bare`` drives serve only to be judged: they lack places and the numbers and ids
    behind signals.

    Raises RulecError R0502 or R0503 if an assumed value does not fit the vocabulary. Otherwise
    every drive would be refused, as if its own values were wrong.
    """

    vocabulary: Vocabulary | None = None
    names: frozenset[str] | None = None
    assumed: Mapping[str, Value] = field(default_factory=dict)
    defaults: bool = False
    bare: bool = False

    def __post_init__(self) -> None:
        if self.vocabulary is not None:
            check_assumed(self.assumed, self.vocabulary)


ALL_SIGNALS = TraceWriter()


def to_traces(
    context: DriveContext, egos: Sequence[str], names: Sequence[str], writer: TraceWriter
) -> list[Drive]:
    """The drives of ``egos`` as traces with these names, one each.

    Raises UnlikeDrivesError if several drives supply different signals.
    """
    limits = thresholds_by(writer.vocabulary, context.thresholds)
    if limits != context.thresholds:
        context = replace(context, thresholds=limits, computed={})
    read, spans = _names_written(writer), context.spans
    known = ~np.isnan(context.extents.s_min)

    def found(one: DriveContext) -> SignalColumns:
        every = settled(_WORDS(one, read), LEAST_S, context.recording.step_s, spans, known)
        return agreeing(every)

    signals = found(context)
    if _some_may_be_vehicles(context):
        signals = unknown_where_unlike(signals, found(_with_unknown_as_vehicles(context)))
    if context.wrong_way:
        signals = known_only(signals, _WITHOUT_DIRECTION)
    elif (backs := may_back(context)).any():
        by_cell = presence_cells(context).of(backs)
        signals = unknown_in(signals, backs, by_cell, _WITHOUT_DIRECTION)
    types = [body.object_types for body in context.tracks.participants]
    chosen, texts = written(signals, types, writer.vocabulary, writer.names, spans)
    chosen, texts = with_assumed(chosen, texts, writer.assumed, context.states)
    if writer.defaults and writer.vocabulary is not None:
        chosen = with_likeliest(chosen, writer.vocabulary)
    kinds = kinds_of(chosen, texts)
    vocabulary = writer.vocabulary
    told = frozenset(kinds)
    if vocabulary is not None and writer.defaults:
        told = with_defaulted(told, vocabulary)
    elif vocabulary is not None:
        lacking = values_lacking(map_contents(context).types)
        told |= with_told_values(told - writer.assumed.keys(), vocabulary, lacking)
        told |= told_types(context.recording.form, vocabulary)
    kind_of = [kind[0] if vocabulary is None else known_type(kind, vocabulary) for kind in types]
    present, objects = _objects(context, kind_of)
    parts = signal_parts(chosen, texts, present, spans, defaults=writer.defaults)
    step_s = context.recording.step_s
    ends: Ending = "complete" if writer.defaults else "cut"
    arrays = [
        TraceArrays(name, step_s, columns.stop - columns.start, own, ends=ends, told=told, **part)
        for name, columns, own, part in zip(names, spans.slices, objects, parts, strict=True)
    ]
    starts = [round(start * step_s, 9) for start in context.steps[spans.begins].tolist()]
    if writer.bare:
        return [Drive(*own, kinds) for own in zip(egos, starts, arrays, strict=True)]
    decided_by = _decided_by(context, chosen, present, objects)
    places = _places(context)
    return [
        Drive(
            ego,
            start_s,
            own,
            kinds,
            decided_by=decided,
            places=places.part(columns),
            whom={name: ids[columns].tolist() for name, ids in signals.whom.items()},
        )
        for ego, start_s, own, decided, columns in zip(
            egos, starts, arrays, decided_by, spans.slices, strict=True
        )
    ]


def _some_may_be_vehicles(context: DriveContext) -> bool:
    """Whether participants of unknown type move on or beside ego's road: they may be vehicles."""
    unknown = context.tracks.types.of_unknown()[context.tracks.rows] & ~context.stays
    return bool(context.relevant[unknown].any())


def _with_unknown_as_vehicles(context: DriveContext) -> DriveContext:
    tracks = context.tracks
    types = tracks.types.unknown_as_vehicles()
    return replace(
        context,
        tracks=tracks.seen_as(tracks.participants, types, tracks.rows),
        computed={},
    )


def _objects(
    context: DriveContext, kind_of: Sequence[str | None]
) -> tuple[WrittenPresences, list[dict[str, str]]]:
    """The presences of participants of known kind, and each drive's objects with their kinds."""
    runs, cells, kept = presence_runs(context), presence_cells(context), None
    drives, rows, ranges = runs.drives, runs.rows, np.array((runs.first, runs.last)).T
    names = presence_names(context)
    are_known = np.array([kind is not None for kind in kind_of], dtype=bool)
    if not are_known.all():
        known = are_known[rows].nonzero()[0]
        drives, rows, ranges = drives[known], rows[known], ranges[known]
        names = [names[number] for number in known.tolist()]
        kept = are_known[cells.rows].nonzero()[0]
    bounds = drives.searchsorted(np.arange(context.spans.n_drives + 1)).tolist()
    own_places = cells.places if kept is None else cells.places.take(kept)
    kinds: list[Any] = [kind_of[row] for row in rows.tolist()]
    named = list(zip(names, kinds, strict=True))
    objects = [dict(named[begin:end]) for begin, end in pairwise(bounds)]
    return WrittenPresences(bounds, rows, ranges, own_places, kept), objects


def _decided_by(
    context: DriveContext,
    chosen: SignalColumns,
    present: WrittenPresences,
    objects: Sequence[Mapping[str, str]],
) -> list[dict[str, DecidedBy]]:
    """For each drive the numbers that decided its signals."""
    if "safe_gap" not in chosen.about:
        return [{} for _ in objects]
    followed, place = safe_gaps(context), context.tolerances.place_m
    found, every = [], present.rows.tolist()
    for own, (begin, end), columns in zip(
        objects, pairwise(present.bounds), context.spans.slices, strict=True
    ):
        numbers = DecidedBy(
            "gap",
            "m",
            dict(zip(own, every[begin:end], strict=True)),
            columns,
            followed.cells,
            values=followed.gap,
            limits=followed.safe,
            value_error=place,
            limit_errors=followed.safe_error,
        )
        found.append({"safe_gap": numbers})
    return found


def _names_written(writer: TraceWriter) -> SignalNames:
    """The names of the signals that will be written; None means all."""
    if writer.vocabulary is None:
        return None
    declared = frozenset(writer.vocabulary.declarations)
    return declared if writer.names is None else declared & writer.names


def _places(context: DriveContext) -> DrivePlaces:
    own = own_lanelets(context)
    ids = tuple([lanelet.id for lanelet in own.lanelets])
    return DrivePlaces(context.ego.x[0], context.ego.y[0], own.number, ids)
