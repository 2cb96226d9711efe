"""Times measured by a sensor, put on an even grid of time steps."""

from __future__ import annotations

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.recording import MOST_STEPS, SPARSEST

MOST_OFF = 0.25
"""How far a time may be off its step, as a fraction of the step."""

_MILLISECONDS = 1000.0


def even_steps(times_s: NDArray[float64]) -> tuple[float, NDArray[int64]]:
    """The time step (s), in whole milliseconds, and the step number of each time.

    The step is the median interval between times; for a single time it is 0.1 s. Steps may be
    missing. Raises ValueError with the reason if the times do not fit.
    """
    if not len(times_s):
        raise ValueError("there are no times")
    if not np.isfinite(times_s).all() or np.abs(times_s).max() > 1e12:
        raise ValueError("a time is no number of seconds")
    if len(times_s) == 1:
        return 0.1, np.zeros(1, dtype=int64)
    between = np.diff(times_s)
    if between.min() <= 0:
        raise ValueError("its times do not ascend")
    step_s = round(float(np.median(between)) * _MILLISECONDS) / _MILLISECONDS
    if step_s <= 0:
        raise ValueError("its times are less than half a millisecond apart")
    # From the intervals: with a slow or fast clock, times since the start would be a step off
    counts = np.round(between / step_s)
    off = np.abs(between / step_s - counts)
    if off.max() > MOST_OFF or counts.min() < 1:
        at = int(np.argmax(off))
        raise ValueError(
            f"its times are uneven: {between[at]:g} s from one to the next is not a multiple of "
            f"{step_s:g} s"
        )
    if counts.sum() > min(MOST_STEPS, SPARSEST * len(times_s)):
        raise ValueError(f"its {len(times_s)} times are spread over {counts.sum():.0f} steps")
    return step_s, np.concatenate(([0], np.cumsum(counts))).astype(int64)
