"""Times measured by a sensor, put on an even grid of time steps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.recording import MOST_STEPS, SPARSEST

MOST_OFF = 0.25
"""How far a time may be off its place, as a fraction of the step."""


def even_steps(
    times_s: NDArray[float64], refused: Callable[[str], RulecError], per_second: int = 1000
) -> tuple[float, NDArray[int64]]:
    """The time step (s), and the step number of each time.

    The step is the usual interval between times, rounded to a part ``per_second``; for a single
    time it is 0.1 s. Steps may be missing. Times fit if each is close to its place: at a multiple
    of the step after the time before it, or on the grid that fits all of them. Raises what is
    ``refused`` with the reason if they do not.
    """
    if not len(times_s):
        raise refused("there are no times")
    if not np.isfinite(times_s).all() or np.abs(times_s).max() > 1e12:
        raise refused("a time is no number of seconds")
    if len(times_s) == 1:
        return 0.1, np.zeros(1, dtype=int64)
    between = np.diff(times_s)
    if between.min() <= 0:
        raise refused("its times do not ascend")
    interval = _usual_interval(times_s)
    step_s = round(interval * per_second) / per_second
    if step_s <= 0:
        raise refused(f"its times are less than {0.5 / per_second:g} s apart")
    # From the intervals: with a slow or fast clock, times since the start would be a step off
    counts = np.round(between / step_s)
    off = np.abs(between / step_s - counts)
    numbers = np.append(0.0, np.cumsum(counts))
    # Two times may each be off by as much, in opposite directions; but most intervals are even
    shifted = np.ptp((times_s - times_s[0]) / interval - numbers)
    is_near = np.median(off) <= MOST_OFF and shifted <= 2 * MOST_OFF
    if (off.max() > MOST_OFF and not is_near) or counts.min() < 1:
        at = int(np.argmax(off))
        raise refused(
            f"its times are uneven: {between[at]:g} s from one to the next is not a multiple of "
            f"{step_s:g} s"
        )
    if counts.sum() > min(MOST_STEPS, SPARSEST * len(times_s)):
        raise refused(
            f"its {len(times_s)} times are spread over {counts.sum():.0f} steps: look for a time "
            "that is wrong, or take a part"
        )
    return step_s, numbers.astype(int64)


def _usual_interval(times_s: NDArray[float64]) -> float:
    """The usual time (s) from one step to the next, measured over many of them.

    From one to the next only, it would be too long or too short where every other time is late.
    """
    between = np.diff(times_s)
    counts = np.maximum(np.round(between / np.median(between)), 1)
    numbers = np.append(0.0, np.cumsum(counts))
    half = len(times_s) // 2
    return float(np.median((times_s[half:] - times_s[:-half]) / (numbers[half:] - numbers[:-half])))
