"""Nearly even times, such as those of sweeps, put on a grid of time steps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy import int64
from numpy.typing import NDArray

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.recording import MOST_STEPS, SPARSEST

NANOSECONDS = 1_000_000_000
"""Nanoseconds per second."""

_UNIT_NS = 10_000_000
"""Unit (ns) of time steps, 0.01 s: sweeps are 0.1 s apart to within a millisecond."""

_LONGEST_NS = 10 * NANOSECONDS

_MOST_OFF = 0.25
"""How far a time may be off its step, as a fraction of the step."""


def on_grid(path: Path, form: FileFormat, moments: NDArray[int64]) -> tuple[NDArray[int64], float]:
    """The time step of each of the ascending times (ns), and the length of a step (s).

    Raises RulecError R0610 for times that fit no grid, or are too far apart.
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
