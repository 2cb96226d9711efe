"""Durations: a value that lasts for less than its word's least one is noise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.tracks import Flags
from rulec.trace.cells import Cells
from rulec.trace.end_to_end import EndToEnd
from rulec.trace.plain_arrays import distinct

_HAIR = 1e-6
_MOST_CHANGES = 2

_IMPLIED: Mapping[str, Sequence[str]] = {
    "stopped": ("parked", "boarding", "stopped_for_pedestrian"),
    "junction_zone": ("enters_junction",),
    "level_crossing_zone": ("enters_level_crossing",),
    "warning_lights": ("hazard_lights",),
}
"""Signal -> those that it holds with, as the vocabulary's facts say."""


def fewest_states(least_s: float, step_s: float) -> int:
    """How many states a value lasts for at least that lasts for so long (s)."""
    return ceil(least_s / step_s - _HAIR)


def settled(
    signals: SignalColumns,
    least_s: Mapping[str, float],
    step_s: float,
    spans: EndToEnd,
    there: Flags | None = None,
) -> SignalColumns:
    """The signals of drives without values that are shorter than their word's least duration (s).

    Such a value between two equal ones becomes theirs, and no better known than they. At the ends
    of a recording, and where others come or go, who are not ``there`` (a row each) before or after,
    nobody knows it: it may be noise or last.
    """
    least = {name: fewest_states(seconds, step_s) for name, seconds in least_s.items()}
    unknown = dict(signals.unknown)
    comes = None if there is None else _coming_or_going(there, spans)
    world, about = (
        {**columns, **_changed(columns, least, unknown, spans, parts)}
        for columns, parts in ((signals.world, None), (signals.about, comes))
    )
    return signals._replace(world=world, about=about, unknown=unknown)


def agreeing(signals: SignalColumns) -> SignalColumns:
    """The signals with each true, and known to be, where one that implies it surely is.

    Each may have been settled by itself, or found by a measure of its own.
    """
    world, about, unknown = dict(signals.world), dict(signals.about), dict(signals.unknown)
    for name, stronger in _IMPLIED.items():
        for columns in (world, about):
            for other in stronger if name in columns else ():
                if other in columns:
                    sure = columns[other] & ~unknown.get(other, np.False_)
                    columns[name] = columns[name] | sure
                    if name in unknown:
                        unknown[name] = unknown[name] & ~sure
    return signals._replace(world=world, about=about, unknown=unknown)


def _changed(
    columns: Mapping[str, SignalColumn],
    least: Mapping[str, int],
    unknown: dict[str, Flags],
    spans: EndToEnd,
    parts: Flags | None,
) -> dict[str, SignalColumn]:
    """The columns that change by being settled, each as it is then.

    What is not known of them, or of others, is added to ``unknown``.
    """
    changed: dict[str, SignalColumn] = {}
    for names in _alike(columns, least):
        before = np.array([columns[name] for name in names])
        after = without_blips(before, least[names[0]], spans, parts)
        brief = _brief_at_ends(after, least[names[0]], spans)
        if parts is not None:
            brief |= _brief_beside(after, least[names[0]], spans, parts)
        for number, name in enumerate(names):
            if after is not before and (blips := after[number] != before[number]).any():
                changed[name] = after[number]
                if (flags := unknown.get(name)) is not None:
                    unknown[name] = flags | _next_to(blips & ~flags, flags, spans)
            if brief[number].any():
                unknown[name] = brief[number] | unknown.get(name, False)
    return changed


def _alike(
    columns: Mapping[str, SignalColumn], least: Mapping[str, int]
) -> Iterable[Sequence[str]]:
    """The names of columns with a least number of states, those of one kind and number together.

    Without those of what is never so, which no value interrupts.
    """
    groups: dict[object, list[str]] = {}
    for name, column in columns.items():
        if least.get(name, 1) > 1 and column.any():
            groups.setdefault((column.dtype, least[name]), []).append(name)
    return groups.values()


def _next_to(changed: Flags, flags: Flags, spans: EndToEnd) -> Flags:
    """Flags of changed states next to flagged ones, across others that have changed, too."""
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
    """Flags of the values that a column, or rows, begins or ends with for fewer states."""
    brief, either = np.zeros(column.shape, dtype=bool), np.logical_or.accumulate
    of_drive = np.minimum(least, spans.lengths) - 1
    for most in distinct(of_drive[of_drive > 0]).tolist():
        own = of_drive == most
        # From each end of a drive so many states to the inside, and one more
        near = np.arange(most + 1)
        for edge, way in ((spans.begins, 1), (spans.begins + spans.lengths - 1, -1)):
            columns = edge[own][:, None] + way * near
            values = column[..., columns]
            changes = values[..., :-1] != values[..., 1:]
            brief[..., columns[:, :-1]] |= either(changes[..., ::-1], axis=-1)[..., ::-1]
    return brief


def _coming_or_going(there: Flags, spans: EndToEnd) -> Flags | None:
    """Flags of the states in which others, a row each, come or are gone; None if nobody does."""
    found = np.zeros(there.shape, dtype=bool)
    found[:, 1:] = there[:, 1:] != there[:, :-1]
    found[:, spans.begins] = False
    return found if found.any() else None


def _brief_beside(column: SignalColumn, least: int, spans: EndToEnd, parts: Flags) -> Flags:
    """Flags of values, by row, that last for fewer states from where somebody comes or is gone."""
    starts, at_end = _runs(column, spans, parts)
    lengths = starts[1:] - starts[:-1]
    brief: Flags = (at_end[:-1] != at_end[1:]) & (lengths < least)
    return brief.repeat(lengths).reshape(column.shape)


def _runs(
    column: SignalColumn, spans: EndToEnd, parts: Flags | None
) -> tuple[NDArray[intp], Flags]:
    """Where runs of one value begin, in all rows laid flat, and flags of those with none before.

    Behind them all is one more.
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

    Only between equal neighbours, from the first on: flicker becomes what it began with. Where
    there are none it is the column itself. What is beyond where somebody comes or is gone,
    flagged in ``parts``, is no neighbour.
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
    """Codes without what goes to and fro in doubt, between the sure codes before and after it.

    Noise does so: where all in between are one of these two, the later one holds from where it
    first comes. Rows with a column per state, in all of which one is ``there``.
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
    found.ravel()[places[fits]] = np.where(later, late, early)[fits]
    return found


class _BetweenSure(NamedTuple):
    """The doubtful states between two sure ones, in all of which one is there.

    Their numbers, and those of the sure ones ``before`` and ``behind``, among the ``codes`` of the
    ``spans`` with any doubt; their ``places`` in the whole.
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
    """Flags of doubtful states between sure ones of different codes: only when is in doubt.

    Rows with a column per state. That is so of ``most`` states at a time, in all of which one is
    ``there``, and whose codes do not go to and fro.
    """
    found = np.zeros(doubtful.shape, dtype=bool)
    if not doubtful.any():
        return found
    own, near, _, before, behind, places = _between_sure(codes, doubtful, there, spans)
    changes = own.changes(near).cumsum()
    # Codes that differ at the ends are all different, or go to and fro
    one_way = changes.take(behind) - changes.take(before) <= _MOST_CHANGES
    only = one_way & (near.take(before) != near.take(behind)) & (behind - before - 1 <= most)
    found.ravel()[places[only]] = True
    return found
