"""How far headings may be wrong, as the tracks themselves show.

A body turns smoothly while it moves, so high differences of its headings show their noise. Where a
heading is only the direction of a way between places, the noise of these shows in it, the more the
shorter the way.
"""

from __future__ import annotations

from math import comb, sqrt

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.recording_parts import (
    ENOUGH_DIFFERENCES,
    MOVES_M,
    OF_MEDIAN,
    order_of_differences,
)
from rulec.extraction.tracks.source_tolerances import MOST_SIGMAS
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.recording import WholeRecording
from rulec.scenario.recorded.reference_line import turn

_DERIVED_RAD, _ROUNDED_M = 1e-3, 2e-3
"""A heading derived from a way differs from it by rounding: its own, and that of places."""

_STEP_M = 0.05
"""A way shorter than this has hardly a direction."""

_MOVES_MPS = 1.0
"""Noise of places does not make anybody so fast over a second."""

_MOST, _FEWEST = 0.8, 5
"""Headings are directions of ways if this part of them are, of at least so many."""

_WAYS = ((0, 1), (1, 0), (1, 1))
"""A heading may be the direction of the way onward, of the way there, or of both together."""

_OVER_M = 1.0
"""A direction that a reader derived is that of a metre or more."""


def heading_errors(
    tracks: Tracks, whole: WholeRecording, step_s: float, *, are_stated: bool = False
) -> Floats:
    """The possible errors (rad) of headings by participant and step, a right angle at most.

    ``are_stated``: the source states all headings, so that none is a direction of motion.
    """
    by_noise = MOST_SIGMAS * _noise_of_headings(tracks, whole, step_s)
    noise_m = MOST_SIGMAS * sqrt(2.0) * whole.noise_m
    errors = by_noise[:, None].repeat(tracks.present.shape[1], axis=1)
    if noise_m > 0 and not are_stated:
        np.maximum(errors, noise_m / _ways_of_headings(tracks), out=errors)
    return np.minimum(errors, np.pi / 2)


def _noise_of_headings(tracks: Tracks, whole: WholeRecording, step_s: float) -> Floats:
    """The standard deviation (rad) of each participant's headings from a smooth turn.

    That of the whole recording for one that moves too shortly.
    """
    noise = np.full(len(tracks.participants), whole.noise_rad)
    order = order_of_differences(step_s)
    if order is None or tracks.present.shape[1] <= order:
        return noise
    x, y = tracks.x, tracks.y
    differences = turn(tracks.heading[:, :-1], tracks.heading[:, 1:])
    for _ in range(order - 1):
        differences = differences[:, 1:] - differences[:, :-1]
    moved = np.hypot(x[:, order:] - x[:, :-order], y[:, order:] - y[:, :-order])
    counts = (moved > MOVES_M) & ~np.isnan(differences)
    for row in (counts.sum(axis=1) >= ENOUGH_DIFFERENCES).nonzero()[0].tolist():
        of_median = float(np.median(np.abs(differences[row, counts[row]])))
        noise[row] = of_median * OF_MEDIAN / sqrt(comb(2 * order, order))
    return noise


def _ways_of_headings(tracks: Tracks) -> Floats:
    """The length (m) of the way of which each heading is the direction; infinity where of none."""
    lengths = np.full(tracks.present.shape, np.inf)
    states = tracks.present.shape[1]
    for before, after in _WAYS:
        way, derived = _as_derived(tracks, before, after)
        if derived.any():
            inner = slice(before, states - after)
            of_way = np.full(lengths.shape, _STEP_M)
            of_way[:, inner] = np.where(np.isnan(way), _STEP_M, np.maximum(way, _STEP_M))
            # A track's last heading is mostly repeated
            ends = slice(None, before), slice(states - after, None)
            of_way[:, ends[0]] = of_way[:, before : before + 1]
            of_way[:, ends[1]] = of_way[:, states - after - 1 : states - after]
            np.minimum(lengths, of_way, out=lengths, where=derived[:, None])
    by_reader = _without_headings(tracks)
    if by_reader.any():
        steps = np.full(lengths.shape, _OVER_M)
        x, y = (at[:, 1:] - at[:, :-1] for at in (tracks.x, tracks.y))
        steps[:, 1:] = np.fmax(np.hypot(x, y), _OVER_M)
        np.minimum(lengths, steps, out=lengths, where=by_reader[:, None])
    return lengths


def head_as_they_move(tracks: Tracks) -> Flags:
    """Mask of participants whose headings are no more than the directions of their motion."""
    found = _without_headings(tracks)
    for before, after in _WAYS:
        found |= _as_derived(tracks, before, after)[1]
    return found


def _as_derived(tracks: Tracks, before: int, after: int) -> tuple[Floats, Flags]:
    """The ways (m) around states, and the mask of participants whose headings are their directions.

    From so many steps before the states to so many after them.
    """
    states = max(tracks.present.shape[1] - before - after, 0)
    x, y = (at[:, before + after :] - at[:, :states] for at in (tracks.x, tracks.y))
    way = np.hypot(x, y)
    inner = slice(before, before + states)
    # The headings of those who stand are mended
    moves = (way > _STEP_M) & (np.hypot(tracks.vx[:, inner], tracks.vy[:, inner]) >= _MOVES_MPS)
    apart = np.abs(turn(tracks.heading[:, inner], np.arctan2(y, x)))
    fits = moves & (apart <= _DERIVED_RAD + _ROUNDED_M / np.where(moves, way, 1.0))
    count = moves.sum(axis=1)
    return way, (fits.sum(axis=1) >= _MOST * count) & (count >= _FEWEST)


def _without_headings(tracks: Tracks) -> Flags:
    """Mask of participants whose file states no headings."""
    return np.array([body.heads_as_it_moves for body in tracks.participants], dtype=bool)
