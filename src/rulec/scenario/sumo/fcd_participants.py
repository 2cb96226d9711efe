"""Participants on a grid of time steps, from floating-car data."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import gcd
from pathlib import Path

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.scenario.recorded.recording import Lamp, Participant
from rulec.scenario.recorded.track import Track, TrackOutlines, TrackStates
from rulec.scenario.sumo.fcd import FCD, MICROSECONDS, FcdTrack
from rulec.scenario.sumo.vehicle_types import VehicleType

MOST_STEPS = 1_000_000
"""A recording has fewer, which is more than a day of tenths of a second."""

SPARSEST = 1000
"""One in so many time steps is in the file at least; else one of its times is a slip."""

_LAMPS: tuple[tuple[int, frozenset[Lamp]], ...] = (
    (1, frozenset({"right_indicator"})),
    (2, frozenset({"left_indicator"})),
    (4, frozenset({"left_indicator", "right_indicator"})),
    (8, frozenset({"brake_light"})),
)
"""The bits of SUMO's ``signals`` that others can see and that rules are about."""


def time_step(path: Path, moments: list[int]) -> float:
    """The time step (s): the shortest time between two moments of the file.

    Moments may be missing, as when nobody was there; what lies between two steps may not be. With
    one moment only it is a second, or the part of one that goes into its time. Raises RulecError
    R0610 for moments that are not all on one grid from time 0 on, or too far apart.
    """
    if len(moments) < 2:
        return gcd(MICROSECONDS, *moments) / MICROSECONDS
    step = min(after - before for before, after in pairwise(moments))
    off = next((moment for moment in moments if moment % step), None)
    if off is not None:
        why = (
            f"its times are uneven: {off / MICROSECONDS:g} s is no multiple of "
            f"{step / MICROSECONDS:g} s, the shortest time from one to the next"
        )
        way_out = "have SUMO write every step, or one in so many (--device.fcd.period)"
        raise FCD.refused(path, why, help_text=way_out)
    spread = (moments[-1] - moments[0]) // step
    if spread > min(MOST_STEPS, SPARSEST * len(moments)):
        why = (
            f"its {len(moments)} time steps of {step / MICROSECONDS:g} s are spread over "
            f"{(moments[-1] - moments[0]) / MICROSECONDS:g} s"
        )
        raise FCD.refused(path, why, help_text="look for a time that is wrong, or take a part")
    return step / MICROSECONDS


def fcd_participants(
    key: str, track_rows: FcdTrack, kind: VehicleType, steps: NDArray[int64], step_s: float
) -> Iterator[Participant]:
    """The participants of a track: who vanishes and comes back is another one then.

    ``steps``: the time step of every moment of the file.
    """
    own = steps[np.array(track_rows.moments, dtype=int64)]
    rows = _centres(np.array(track_rows.rows, dtype=float).reshape(-1, 4), kind.length)
    rows = np.column_stack((rows, _accelerations(track_rows, rows[:, 3], own, step_s)))
    lamps = {int(steps[moment]): _lit(bits) for moment, bits in track_rows.lamps.items()}
    starts = np.flatnonzero(np.diff(own, prepend=own[0] - 2) > 1)
    for number, (start, end) in enumerate(zip(starts, [*starts[1:], len(own)], strict=True), 1):
        track = Track(own[start:end], rows[start:end], kind.length, kind.width)
        name = key if number == 1 else f"{key}_{number}"
        first, last = int(own[start]), int(own[end - 1])
        yield Participant(
            id=name,
            type=kind.kind,
            standing=False,
            states=TrackStates(track),
            outlines=TrackOutlines(track),
            lamps={step: lit for step, lit in lamps.items() if first <= step <= last},
        )


def _centres(rows: NDArray[float64], length: float) -> NDArray[float64]:
    """From bumpers and compass angles to centres and headings."""
    heading = np.pi / 2 - np.radians(rows[:, 2])
    heading = (heading + np.pi) % (2 * np.pi) - np.pi
    x = rows[:, 0] - length / 2 * np.cos(heading)
    y = rows[:, 1] - length / 2 * np.sin(heading)
    return np.column_stack((x, y, heading, rows[:, 3]))


def _accelerations(
    track_rows: FcdTrack, speeds: NDArray[float64], steps: NDArray[int64], step_s: float
) -> NDArray[float64]:
    """The accelerations, as stated or else from the difference of speed since the step before."""
    stated = np.array(track_rows.accelerations, dtype=float)
    changes = np.diff(speeds, prepend=speeds[0]) / (np.diff(steps, prepend=steps[0] - 1) * step_s)
    return np.where(np.isnan(stated), changes, stated)


def _lit(bits: int) -> frozenset[Lamp]:
    return frozenset(lamp for bit, lamps in _LAMPS if bits & bit for lamp in lamps)
