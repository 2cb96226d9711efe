"""Fills short holes of tracks: a participant unseen for a moment was still there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy import float64, int64, intp
from numpy.typing import NDArray

from rulec.recordings.mending.cut_tracks import missing_remark
from rulec.recordings.mending.rows_of_states import rows_of, steps_of, with_mended, with_rows
from rulec.recordings.mending.track_jumps import DRIVERS
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Lamp, Participant, Recording

LONGEST_HOLE_S = 1.0
"""Who is missing for longer is another participant when it returns, unless told otherwise."""

HOLES_WHY = f"holes of more than {LONGEST_HOLE_S:g} s, in which nothing is judged"

_FASTER, _FASTER_MPS = 1.3, 3.0
"""The factor and difference by which a jump in a hole exceeds the speeds on both sides."""

_LARGEST_TURN = np.pi / 4
"""A larger turn within a hole counts as a jump."""


def without_short_holes(recording: Recording, longest_s: float) -> Recording:
    """A recording without holes of tracks between two states at most ``longest_s`` apart.

    The added states are on the cubic through the two states before and the two after. None are
    added if the participant jumped; lamps are lit in them only if they are lit on both sides. A
    remark names those who drive, and are missing for longer.
    """
    most = most_steps(longest_s, recording.step_s)
    missing: list[str] = []

    def filled(body: Participant) -> Participant:
        if body.standing:
            return body
        steps = steps_of(body)
        if len(steps) and steps[-1] - steps[0] >= len(steps):
            if (np.diff(steps) > max(most, 1)).any() and not DRIVERS.isdisjoint(body.object_types):
                missing.append(body.id)
            return _filled(body, steps, most, recording.step_s)
        return body

    whole = with_mended(recording, filled)
    if not missing:
        return whole
    remark = missing_remark(missing, longest_s)
    return replace(whole, remarks=(*whole.remarks, remark))


def most_steps(longest_s: float, step_s: float) -> int:
    """The most steps between two states at most ``longest_s`` (s) apart."""
    return int(longest_s / step_s + 1e-9)


class TrackHoles(NamedTuple):
    """The holes of a track, each as the row before it.

    Those longer than ``LONGEST_HOLE_S``; shorter ones in which it jumps; and others.
    """

    longer: NDArray[intp]
    with_jumps: NDArray[intp]
    short: NDArray[intp]


def holes_of(steps: NDArray[int64], rows: NDArray[float64], step_s: float) -> TrackHoles:
    """The holes of a track; ``rows`` are x, y (m), heading (rad) and speed (m/s) by ``steps``."""
    apart = np.diff(steps)
    holes = (apart > 1).nonzero()[0]
    most = max(most_steps(LONGEST_HOLE_S, step_s), 1)
    known = _Known(steps, rows, 2 * most, step_s)
    is_long = apart[holes] > most
    jumps = [
        not far and known.jumps(hole) for far, hole in zip(is_long, holes.tolist(), strict=True)
    ]
    jumped = np.array(jumps, dtype=bool)
    return TrackHoles(holes[is_long], holes[jumped], holes[~is_long & ~jumped])


def _filled(body: Participant, steps: NDArray[int64], most: int, step_s: float) -> Participant:
    apart = np.diff(steps)
    holes = ((apart > 1) & (apart <= most)).nonzero()[0]
    if not len(holes) or body.states.keys() != body.outlines.keys():
        return body
    rows = rows_of(body)
    own = _Known(steps, rows, 2 * most, step_s)
    missing = [
        steps[hole] + np.arange(1, apart[hole]) for hole in holes.tolist() if not own.jumps(hole)
    ]
    if not missing:
        return body
    new_steps = np.concatenate(missing)
    new_rows = np.concatenate([own.at(some) for some in missing])
    every = np.concatenate((steps, new_steps))
    order = every.argsort(kind="stable")
    whole = with_rows(body, every[order], np.concatenate((rows, new_rows))[order])
    return replace(whole, lamps=_lamps(body, steps, holes))


@dataclass(frozen=True, eq=False, slots=True)
class _Known:
    """The steps of a track and their rows.

    States up to ``near`` steps away determine a hole's speed.
    """

    steps: NDArray[int64]
    rows: NDArray[float64]
    near: int
    step_s: float

    def jumps(self, hole: int) -> bool:
        """Whether the speed or turn within a hole exceeds that of a vehicle that drives on."""
        around = self._around(hole)
        moved = np.hypot(*np.diff(self.rows[around, :2], axis=0).T)
        speeds = moved / np.diff(self.steps[around]) / self.step_s
        in_hole = around.searchsorted(hole)
        stated = np.abs(self.rows[hole : hole + 2, 3]).max()
        fastest = max(float(stated), *np.delete(speeds, in_hole).tolist(), 0.0)
        turned = abs(wrapped(np.diff(self.rows[hole : hole + 2, 2]))[0])
        too_fast = speeds[in_hole] > fastest * _FASTER + _FASTER_MPS
        return bool(too_fast or turned > _LARGEST_TURN)

    def at(self, missing: NDArray[int64]) -> NDArray[float64]:
        """The rows of the missing steps of one hole."""
        hole = int(self.steps.searchsorted(missing[0])) - 1
        before, behind = self.rows[hole], self.rows[hole + 1]
        share = (missing - self.steps[hole]) / (self.steps[hole + 1] - self.steps[hole])
        gained = behind - before
        gained[2] = wrapped(gained[2:3])[0]
        values: NDArray[float64] = before + share[:, None] * gained
        around = self._around(hole)
        values[:, :2] = _cubic(self.steps[around], self.rows[around, :2], missing)
        return values

    def _around(self, hole: int) -> NDArray[intp]:
        around: NDArray[intp] = np.arange(max(hole - 1, 0), min(hole + 3, len(self.steps)))
        near: NDArray[intp] = around[np.abs(self.steps[around] - self.steps[hole]) <= self.near]
        return near


def _cubic(
    steps: NDArray[int64], places: NDArray[float64], wanted: NDArray[int64]
) -> NDArray[float64]:
    """Places on the polynomial of least degree through given places."""
    interpolated = np.zeros((len(wanted), 2))
    for k, step in enumerate(steps.tolist()):
        others = np.delete(steps, k)
        weight = np.prod((wanted[:, None] - others) / (step - others), axis=1)
        interpolated += weight[:, None] * places[k]
    return interpolated


def _lamps(
    body: Participant, steps: NDArray[int64], holes: NDArray[intp]
) -> dict[int, frozenset[Lamp]]:
    """The lamps, extended into holes if they are lit on both sides."""
    lamps = dict(body.lamps)
    for hole in holes.tolist():
        before, behind = int(steps[hole]), int(steps[hole + 1])
        if before in lamps and lamps[before] == lamps.get(behind):
            lamps |= dict.fromkeys(range(before + 1, behind), lamps[before])
    return lamps
