"""Even time steps for a trace's moments, whose times jitter by some nanoseconds or more."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy import int64
from numpy.typing import NDArray

from rulec.recordings.osi.trace_file import OSI
from rulec.recordings.recording import MOST_STEPS, SPARSEST

UNEVEN = 0.1
"""How far a time may be off its step, as a fraction of it; beyond that, recording is uneven."""

_UNSAID = 0.01
_UNITS = (1_000_000, 100_000, 10_000, 1_000, 1)
_NS = 1e9


class TimeGrid(NamedTuple):
    """The time step (s), the step number of each moment from 0 on, and the time errors (s)."""

    step_s: float
    steps: NDArray[int64]
    off_s: float

    @property
    def is_even(self) -> bool:
        """Whether every time is off by at most a hundredth of a step."""
        return self.off_s <= _UNSAID * self.step_s


def time_grid(path: Path, times: Sequence[int]) -> TimeGrid:
    """The time grid of ascending times (ns): the roundest step that fits, from the first time on.

    Moments may be missing. For a single moment the step is 0.1 s. Raises RulecError R0610 for times
    that fit no step or are too far apart.
    """
    since = np.array(times, dtype=int64) - times[0]
    if len(times) == 1:
        return TimeGrid(0.1, since, 0.0)
    usual = float(np.median(np.diff(since)))
    # The mean of many steps is more precise than each of them
    usual = float(since[-1]) / max(round(float(since[-1]) / usual), 1)
    spread = float(since[-1]) / usual
    if spread > min(MOST_STEPS, SPARSEST * len(times)):
        why = f"its {len(times):,} moments are spread over {since[-1] / _NS:,.0f} s"
        raise OSI.refused(path, why, help_text="look for a time that is wrong, or take a part")
    rounded = [round(usual / unit) * unit for unit in _UNITS]
    grids = [_on_grid(since, float(step)) for step in (*rounded, usual) if step > 0]
    grid = next((x for x in grids if x.is_even), min(grids, key=lambda x: x.off_s))
    taken = np.diff(grid.steps) == 0
    if taken.any() or grid.off_s > UNEVEN * grid.step_s:
        off = np.abs(since - grid.steps * grid.step_s * _NS)
        at = int(np.argmax(taken)) + 1 if taken.any() else int(np.argmax(off))
        why = (
            f"its times are uneven: {since[at] / _NS:g} s after the first is not a multiple of"
            f" {grid.step_s:g} s, the usual time from one to the next"
        )
        raise OSI.refused(path, why, help_text="have it written at even times, or resampled")
    return grid


def _on_grid(since: NDArray[int64], step: float) -> TimeGrid:
    steps = np.round(since / step).astype(int64)
    return TimeGrid(step / _NS, steps, float(np.abs(since - steps * step).max()) / _NS)
