"""Converts the times of rows to steps of an even grid, tolerating rounding."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.table_columns import Columns
from rulec.recordings.recording import MOST_STEPS, SPARSEST

_UNEVEN = 0.02
"""The share of a step by which a time may be off its grid, besides its rounding."""

_RATES = 1000
_HAIR = 1e-3


class EvenTimes(NamedTuple):
    """The time step (s) and the step of each row; and the time of step 0, if not 0 (s)."""

    step_s: float
    steps: NDArray[int64]
    start_s: float = 0.0


def even_times(
    times: NDArray[float64], columns: Columns, tracks: NDArray[int64] | None = None
) -> EvenTimes:
    """Times (s) as steps: the time step is the shortest interval, or a fraction of it.

    Moments may be missing. A usual value close to the step is used instead: one of 1 to 1000 per
    second, or a thousand of those in 1001 s, as in video; else whole milliseconds. Steps count from
    time 0, or from the first moment if that is off the grid or too far away. With the ``tracks`` of
    the rows, moments that are much closer than a track's rows are one, as of clocks that jitter.
    Raises RulecError for times that are not on an even grid, or too far apart.
    """
    start = float(times.min())
    # Floats have sixteen digits: of seconds since 1970 some seven remain for decimals
    unit = max(unit_of([times - start]), 4 * float(np.spacing(np.abs(times).max())))
    moments = np.unique(np.round((times - start) / unit)) * unit
    if len(moments) == 1:
        return EvenTimes(1.0, np.zeros(len(times), dtype=int64), start)
    if tracks is not None:
        moments = _without_jitter(moments, _usual_interval(times, tracks))
    step = _fitted(moments, unit)
    spread = moments[-1] / step
    if spread > min(MOST_STEPS, SPARSEST * len(moments)):
        why = f"its {len(moments):,} moments, {step:.4g} s apart, spread over {moments[-1]:,.0f} s"
        way_out = "look for a time that is wrong, for another unit (`t_ms`, `t_ns`), or take a part"
        raise columns.refused(why, help_text=way_out)
    steps = np.round((times - start) / step).astype(int64)
    if np.abs(times - start - steps * step).max() > _UNEVEN * step + unit:
        raise _uneven(times, float(np.median(np.diff(moments))), unit, columns)
    first = start / step
    if abs(first) <= MOST_STEPS and abs(first - round(first)) * step <= _UNEVEN * step + unit:
        return EvenTimes(step, steps + round(first))
    return EvenTimes(step, steps, start)


def _usual_interval(times: NDArray[float64], tracks: NDArray[int64]) -> float:
    """The median time (s) from a row of a track to its next one; 0 if none has two."""
    order = np.lexsort((times, tracks))
    onward = np.diff(times[order])[np.diff(tracks[order]) == 0]
    return float(np.median(onward)) if len(onward) else 0.0


def _without_jitter(moments: NDArray[float64], interval: float) -> NDArray[float64]:
    """The moments from the first on, with one in the middle of several that jitter makes of it."""
    begins = np.diff(moments, prepend=-np.inf) > 2 * _UNEVEN * interval
    if begins.all():
        return moments
    group = np.cumsum(begins) - 1
    middles = np.bincount(group, moments) / np.bincount(group)
    found: NDArray[float64] = middles - middles[0]
    return found if len(found) > 1 else moments


def _uneven(times: NDArray[float64], step: float, unit: float, columns: Columns) -> RulecError:
    """The error for times off the grid, which names the first one."""
    since = times - times.min()
    off = np.abs(since - np.round(since / step) * step) > _UNEVEN * step + unit
    row = int(np.argmin(np.where(off, times, np.inf)))
    why = (
        f"its times are uneven: {times[row]:.10g} s is no whole number of steps of {step:.4g} s, "
        f"as most are, after {times.min():.10g} s"
    )
    way_out = "resample the tracks to an even time step, such as 0.1 s"
    return columns.wrong(row, why, help_text=way_out)


def unit_of(columns: Sequence[NDArray[float64]], fewest: int = 0, most: int = 9) -> float:
    """The unit of the last decimal of values without NaN, of which there are some decimals."""
    for decimals in range(fewest, most):
        scaled = [values * 10.0**decimals for values in columns]
        if all((np.abs(values - np.round(values)) < _HAIR).all() for values in scaled):
            return float(10.0**-decimals)
    return float(10.0**-most)


def _fitted(moments: NDArray[float64], unit: float) -> float:
    """The step that fits the moments best, starting at 0; a usual value if it fits."""
    step = float(np.median(np.diff(moments)))
    if np.diff(moments).min() < 0.6 * step:
        step = float(np.diff(moments).min())
    # A step from few moments is known badly: it gets better with each twice as many
    count = 2
    while True:
        part = moments[:count]
        numbers = np.maximum(np.round(part / step), 0)
        if (numbers @ numbers) > 0:
            step = float((numbers @ part) / (numbers @ numbers))
        if count >= len(moments):
            break
        count *= 2
    error = (unit + _UNEVEN / 2 * step) / max(round(moments[-1] / step), 1)
    for frames in (1.0, 1000 / 1001):
        rate = round(1 / step / frames)
        if 1 <= rate <= _RATES and abs(1 / (rate * frames) - step) <= error:
            return 1 / (rate * frames)
    whole = round(step, 3)
    return whole if whole > 0 and abs(whole - step) <= error else step


def framed_times(frames: NDArray[float64], rate: float, columns: Columns) -> EvenTimes:
    """Frame numbers at a rate per second, as steps. Raises RulecError for invalid ones."""
    off = frames != np.round(frames)
    if off.any():
        row = int(np.argmax(off))
        raise columns.wrong(row, f"its frame is {frames[row]:g}", "expected a whole number")
    spread = float(np.ptp(frames))
    count = len(np.unique(frames))
    if spread > min(MOST_STEPS, SPARSEST * count):
        raise columns.refused(f"its {count:,} frames are spread over {spread:,.0f}")
    start = float(frames.min())
    if abs(start) > MOST_STEPS:
        return EvenTimes(1 / rate, (frames - start).astype(int64), start / rate)
    return EvenTimes(1 / rate, frames.astype(int64))
