"""Moments that are nearly even, as those of sweeps are, on a grid of time steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.recording import MOST_STEPS, SPARSEST

NANOSECONDS = 1_000_000_000
"""In a second."""

_UNIT_NS = 10_000_000
"""Sweeps are a tenth of a second apart to within a millisecond; a step is whole hundredths."""

_LONGEST_NS = 10 * NANOSECONDS

_MOST_OFF = 0.25
"""How far a moment may lie off its step, as a part of it."""


def on_grid(path: Path, form: FileFormat, moments: NDArray[int64]) -> tuple[NDArray[int64], float]:
    """The time steps of ascending moments (ns), and how long (s) one takes.

    Raises RulecError R0610 for moments that are on no grid, or too far apart.
    """
    if len(moments) < 2:
        return np.zeros(len(moments), dtype=int), 0.1
    apart = float(np.median(np.diff(moments)))
    step = max(round(apart / _UNIT_NS), 1) * _UNIT_NS
    since = (moments - moments[0]).astype(float)
    if step > _LONGEST_NS or since[-1] / step > min(MOST_STEPS, SPARSEST * len(moments)):
        why = f"its {len(moments)} moments are spread over {since[-1] / NANOSECONDS:g} s"
        raise form.refused(path, why, help_text="look for a time that is wrong, or take a part")
    steps = np.rint(since / step).astype(int)
    off = np.abs(since - steps * step)
    if off.max() > _MOST_OFF * step or (np.diff(steps) == 0).any():
        worst = int(off.argmax())
        why = (
            f"its times are uneven: {moments[worst]} ns is {off[worst] / 1e6:.0f} ms off the grid "
            f"of {step / NANOSECONDS:g} s that most of them are on"
        )
        raise form.refused(path, why)
    return steps, step / NANOSECONDS


def rates(values: NDArray[float64], seconds: NDArray[float64]) -> NDArray[float64]:
    """The rates at which numbers change over time, by central differences; 0 of one alone."""
    if len(values) < 2:
        return np.zeros(len(values))
    gradients: NDArray[float64] = np.gradient(values, seconds)
    return gradients
