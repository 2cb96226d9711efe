"""Durations: a value that lasts for less than its word's least one is noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from math import ceil

import numpy as np

from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.tracks import Flags

_HAIR = 1e-6


def settled(signals: SignalColumns, least_s: Mapping[str, float], step_s: float) -> SignalColumns:
    """The signals without values that are shorter than their word's least duration (s).

    Such a value between two equal ones becomes theirs, and no better known than they. At the ends
    of a recording nobody knows it: it may be noise or last.
    """
    own = {name: ceil(seconds / step_s - _HAIR) for name, seconds in least_s.items()}
    world, about = (
        {name: without_blips(column, own.get(name, 1)) for name, column in columns.items()}
        for columns in (signals.world, signals.about)
    )
    unknown = dict(signals.unknown)
    for name, flags in unknown.items():
        before = signals.world[name] if name in signals.world else signals.about[name]
        after = world[name] if name in world else about[name]
        unknown[name] = flags | _next_to((before != after) & ~flags, flags)
    for columns in (world, about):
        for name in own.keys() & columns.keys():
            brief = _brief_at_ends(columns[name], own[name])
            if brief.any():
                unknown[name] = unknown.get(name, False) | brief
    return replace(signals, world=world, about=about, unknown=unknown)


def _next_to(changed: Flags, flags: Flags) -> Flags:
    """Flags of changed states next to flagged ones, across others that have changed, too."""
    if not changed.any():
        return changed
    places = np.broadcast_to(np.arange(changed.shape[-1]), changed.shape)
    earlier = np.maximum.accumulate(np.where(changed, 0, places), axis=-1)
    last = changed.shape[-1] - 1
    turned = np.where(changed, last, places)[..., ::-1]
    later = np.minimum.accumulate(turned, axis=-1)[..., ::-1]
    either = [np.take_along_axis(flags, where, axis=-1) for where in (earlier, later)]
    found: Flags = changed & (either[0] | either[1])
    return found


def _brief_at_ends(column: SignalColumn, least: int) -> Flags:
    """Flags of the values that a column, or rows, begins or ends with for fewer states."""
    states = column.shape[-1]
    brief = np.zeros(column.shape, dtype=bool)
    for length in range(1, min(least, states)):
        brief[..., :length] |= (column[..., length - 1] != column[..., length])[..., None]
        brief[..., -length:] |= (column[..., -length] != column[..., -length - 1])[..., None]
    return brief


def without_blips(column: SignalColumn, least: int) -> SignalColumn:
    """A column, or rows of them, without values that last for fewer states than ``least``.

    Only between equal neighbours, from the first on: flicker becomes what it began with.
    """
    if least <= 1 or not column.size:
        return column
    rows = column.reshape(-1, column.shape[-1])
    changes = np.ones(rows.shape, dtype=bool)
    changes[:, 1:] = rows[:, 1:] != rows[:, :-1]
    short = np.flatnonzero((changes.sum(axis=1) > 2) & (rows.shape[1] > 2))
    found = np.array(rows)
    for row in short.tolist():
        starts = [*np.flatnonzero(changes[row]).tolist(), rows.shape[1]]
        for start, end in pairwise(starts[1:-1]):
            if end - start < least and found[row, start - 1] == rows[row, end]:
                found[row, start:end] = found[row, start - 1]
    return found.reshape(column.shape)
