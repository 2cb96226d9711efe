"""Durations: a value that lasts for less than its word's least duration is noise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.signals.signal_columns import (
    Measured,
    SignalColumn,
    SignalColumns,
    SignalValues,
)
from rulec.trace.cells import Cells
from rulec.trace.end_to_end import EndToEnd
from rulec.trace.partly_known.partly_known_values import Truth

_HAIR = 1e-6
_MOST_CHANGES = 2

_IMPLIED: Mapping[str, Sequence[str]] = {
    "stopped": ("parked", "boarding", "stopped_for_pedestrian"),
    "junction_zone": ("enters_junction",),
    "level_crossing_zone": ("enters_level_crossing",),
    "warning_lights": ("hazard_lights",),
}
"""Signal -> the signals that imply it by the vocabulary's facts."""


def fewest_states(least_s: float, step_s: float) -> int:
    """The least number of states of a value that lasts for ``least_s`` (s)."""
    return ceil(least_s / step_s - _HAIR)


def settled(
    signals: SignalColumns,
    least_s: Mapping[str, float],
    step_s: float,
    spans: EndToEnd,
    there: Flags | None = None,
) -> SignalColumns:
    """The signals of drives without values shorter than their word's least duration (s).

    Such a value between two equal ones becomes theirs, and no better known than they are; so what
    is possible for a shorter time is not, and what is not sure for a shorter time is. At the ends
    of a recording, and where others come or go (are not ``there``, a row each, before or after), it
    is unknown: it may be noise or last.
    """
    least = {name: fewest_states(seconds, step_s) for name, seconds in least_s.items()}
    comes = None if there is None else _coming_or_going(there, spans)
    world, about = (
        {**own, **_changed(own, least, spans, parts)}
        for own, parts in ((signals.world, None), (signals.about, comes))
    )
    return signals._replace(world=world, about=about)


def agreeing(signals: SignalColumns) -> SignalColumns:
    """The signals, each made true and known where a signal that implies it is surely true.

    Each may have been settled by itself, or found by a measure of its own.
    """
    world, about, faults = dict(signals.world), dict(signals.about), dict(signals.faults)
    for name, stronger in _IMPLIED.items():
        # It may hold where what implies it would be true
        for other in faults.keys() & stronger if name in world or name in about else ():
            faults[name] = faults[other]
        for own in (world, about):
            for other in stronger if name in own else ():
                if other in own:
                    own[name] = _truth(own[name]) | Truth.known(_truth(own[other]).sure)
    return signals._replace(world=world, about=about, faults=faults)


def _truth(values: SignalValues) -> Truth:
    assert isinstance(values, Truth)
    return values


def _changed(
    signals: Mapping[str, SignalValues],
    least: Mapping[str, int],
    spans: EndToEnd,
    parts: Flags | None,
) -> dict[str, SignalValues]:
    """The signals that settling changes. Truth is settled as what is sure and what is possible."""
    changed: dict[str, dict[int, tuple[SignalColumn, Flags]]] = {}
    for own in _alike(signals, least):
        before = np.array([column for _, _, column in own])
        states = least[own[0][0]]
        after = without_blips(before, states, spans, parts)
        brief = _brief_at_ends(after, states, spans)
        if parts is not None:
            brief |= _brief_beside(after, states, spans, parts)
        for number, (name, half, column) in enumerate(own):
            if brief[number].any() or (after is not before and (after[number] != column).any()):
                changed.setdefault(name, {})[half] = after[number], brief[number]
    return {name: _settled(signals[name], halves, spans) for name, halves in changed.items()}


def _settled(
    values: SignalValues, changed: Mapping[int, tuple[SignalColumn, Flags]], spans: EndToEnd
) -> SignalValues:
    """Values with those of their columns that have changed, unknown where these are brief."""
    if isinstance(values, Truth):
        sure, brief = changed.get(0, (values.sure, np.False_))
        possible, may_end = changed.get(0 if values.is_known else 1, (values.possible, np.False_))
        return Truth(sure & ~brief, possible | may_end)
    after, brief = changed[0]
    if values.unknown is not None:
        blips = (after != values.values) & ~values.unknown
        brief = brief | values.unknown | _next_to(blips, values.unknown, spans)
    return replace(values, values=after, unknown=brief)


def _alike(
    signals: Mapping[str, SignalValues], least: Mapping[str, int]
) -> Iterable[Sequence[tuple[str, int, SignalColumn]]]:
    """Columns with a least number of states, by name and half, grouped by type and that number.

    Without columns that are never true, since no value interrupts them.
    """
    groups: dict[object, list[tuple[str, int, SignalColumn]]] = {}
    for name, values in signals.items():
        if least.get(name, 1) > 1:
            for half, column in enumerate(_columns(values)):
                if column.any():
                    key = column.dtype, least[name]
                    groups.setdefault(key, []).append((name, half, column))
    return groups.values()


def _columns(values: SignalValues) -> Sequence[SignalColumn]:
    if isinstance(values, Measured):
        return (values.values,)
    return (values.sure,) if values.is_known else (values.sure, values.possible)


def _next_to(changed: Flags, flags: Flags, spans: EndToEnd) -> Flags:
    """Mask of changed states next to flagged ones, also across other changed states."""
    if not changed.any():
        return changed
    if changed.ndim > 1:
        found, rows = np.zeros(changed.shape, dtype=bool), changed.any(axis=1).nonzero()[0]
        found[rows] = _beside_flagged(changed[rows], flags[rows], spans)
        return found
    return _beside_flagged(changed, flags, spans)


def _beside_flagged(changed: Flags, flags: Flags, spans: EndToEnd) -> Flags:
    earlier = np.maximum(spans.latest(~changed), spans.first)
    later = np.minimum(spans.next_state(~changed), spans.end - 1)
    either = [np.take_along_axis(flags, where, axis=-1) for where in (earlier, later)]
    found: Flags = changed & (either[0] | either[1])
    return found


def _brief_at_ends(column: SignalColumn, least: int, spans: EndToEnd) -> Flags:
    """Mask of values, at a column's or rows' ends, that last for fewer states than ``least``."""
    brief, either = np.zeros(column.shape, dtype=bool), np.logical_or.accumulate
    of_drive = np.minimum(least, spans.lengths) - 1
    for most in np.unique(of_drive[of_drive > 0]).tolist():
        own = of_drive == most
        # This many states inward from each end of a drive, and one more
        near = np.arange(most + 1)
        for edge, way in ((spans.begins, 1), (spans.begins + spans.lengths - 1, -1)):
            columns = edge[own][:, None] + way * near
            values = column[..., columns]
            changes = values[..., :-1] != values[..., 1:]
            brief[..., columns[:, :-1]] |= either(changes[..., ::-1], axis=-1)[..., ::-1]
    return brief


def _coming_or_going(there: Flags, spans: EndToEnd) -> Flags | None:
    """Mask of the states in which others, a row each, come or are gone; None if nobody does."""
    found = np.zeros(there.shape, dtype=bool)
    found[:, 1:] = there[:, 1:] != there[:, :-1]
    found[:, spans.begins] = False
    return found if found.any() else None


def _brief_beside(column: SignalColumn, least: int, spans: EndToEnd, parts: Flags) -> Flags:
    """Mask of values, by row, lasting under ``least`` states from where others come or are gone."""
    starts, at_end = _runs(column, spans, parts)
    lengths = starts[1:] - starts[:-1]
    brief: Flags = (at_end[:-1] != at_end[1:]) & (lengths < least)
    return brief.repeat(lengths).reshape(column.shape)


def _runs(
    column: SignalColumn, spans: EndToEnd, parts: Flags | None
) -> tuple[NDArray[intp], Flags]:
    """The flat indices where runs of one value begin; mask of those with none before them.

    One more index follows at the end.
    """
    begins, ends = np.ones(column.shape, dtype=bool), spans.begins_here
    begins[..., 1:] = column[..., 1:] != column[..., :-1]
    begins[..., spans.begins] = True
    if parts is not None:
        ends = ends | parts
        begins |= parts
    starts = np.append(begins.ravel().nonzero()[0], column.size)
    return starts, ends.ravel()[starts % ends.size]


def without_blips(
    column: SignalColumn, least: int, spans: EndToEnd, parts: Flags | None = None
) -> SignalColumn:
    """A column, or rows of them, without values that last for fewer states than ``least``.

    Changes only those between equal neighbours, from the first on, so that flicker becomes what it
    began with. Returns the column itself if there are none. Values beyond where a participant comes
    or is gone, flagged in ``parts``, are no neighbours.
    """
    starts, at_end = _runs(column, spans, parts)
    between = ~(at_end[:-1] | at_end[1:])
    brief = (between & (starts[1:] - starts[:-1] < least)).nonzero()[0]
    if not len(brief):
        return column
    given, found = column.ravel(), np.array(column).ravel()
    for start, end in zip(starts[brief].tolist(), starts[brief + 1].tolist(), strict=True):
        if found[start - 1] == given[end]:
            found[start:end] = found[start - 1]
    return found.reshape(column.shape)


def with_one_change(
    codes: SignalColumn, doubtful: Flags, there: Flags, spans: EndToEnd
) -> SignalColumn:
    """Codes without alternation in doubtful states between the sure codes before and after.

    Noise alternates: if all codes in between are one of these two, the later one holds from its
    first occurrence. Rows with a column per state; one has to be ``there`` in all of them.
    """
    if not doubtful.any():
        return codes
    _, near, states, before, behind, places = _between_sure(codes, doubtful, there, spans)
    code, early, late = (near.take(at) for at in (states, before, behind))
    fits = (early != late) & ((code == early) | (code == late))
    fits &= np.bincount(before[~fits], minlength=len(near))[before] == 0
    comes = np.full(len(near), len(near))
    np.minimum.at(comes, before, np.where(code == late, states, len(near)))
    later = states >= comes[before]
    found = np.array(codes)
    np.put(found, places[fits], np.where(later, late, early)[fits])
    return found


class _BetweenSure(NamedTuple):
    """The doubtful states between two sure ones, with the participant there throughout.

    ``states`` are their numbers, ``before`` and ``behind`` those of the sure ones, among the
    ``codes`` of the ``spans`` with any doubt; ``places`` are theirs in the whole array.
    """

    spans: EndToEnd
    codes: SignalColumn
    states: NDArray[intp]
    before: NDArray[intp]
    behind: NDArray[intp]
    places: NDArray[intp]


def _between_sure(
    codes: SignalColumn, doubtful: Flags, there: Flags, spans: EndToEnd
) -> _BetweenSure:
    cells, own = Cells.of_drives(doubtful, spans)
    codes, there, doubts = map(cells.of, (codes, there, doubtful))
    sure, states = there & ~doubts, doubts.nonzero()[0]
    before, behind = own.latest(sure).take(states), own.next_state(sure).take(states)
    chosen = ((before >= own.first.take(states)) & (behind < own.end.take(states))).nonzero()[0]
    away = (~there).cumsum()
    chosen = chosen[away.take(behind[chosen]) == away.take(before[chosen])]
    states, before, behind = (values.take(chosen) for values in (states, before, behind))
    places = cells.places.take(states)
    return _BetweenSure(own, codes, states, before=before, behind=behind, places=places)


def only_when(
    codes: SignalColumn, doubtful: Flags, there: Flags, most: int, spans: EndToEnd
) -> Flags:
    """Mask of doubtful states between sure ones of different codes: only the moment is in doubt.

    Rows with a column per state. Applies to at most ``most`` states at a time, in all of which the
    participant is ``there``, and whose codes do not alternate.
    """
    found = np.zeros(doubtful.shape, dtype=bool)
    if not doubtful.any():
        return found
    own, near, _, before, behind, places = _between_sure(codes, doubtful, there, spans)
    changes = own.changes(near).cumsum()
    # Codes that differ at the ends are all different, or alternate
    one_way = changes.take(behind) - changes.take(before) <= _MOST_CHANGES
    only = one_way & (near.take(before) != near.take(behind)) & (behind - before - 1 <= most)
    np.put(found, places[only], True)
    return found
