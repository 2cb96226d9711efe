"""The time steps of frame rates, which recordings state rounded."""

from __future__ import annotations

import math
from decimal import Decimal

_RATES = 1000
_FEWEST_DIGITS = 5
_NOISE = 4
"""By how many neighbouring floats a sum or a quotient of a few floats may be off."""


def frame_step(step_s: float) -> float:
    """The step (s) that a recording's step stands for: that of a frame rate which it rounds.

    Frame rates are 1 to 1000 per second, or a thousand of those in 1001 s, as in video. A number of
    five or more digits rounds a step from which it is off by half a unit of its last digit at most;
    any number may be off by the noise of floats. All other steps stay as they are.
    """
    if not 0 < step_s < math.inf:
        return step_s
    rates = ((1, _rate(1.0, step_s)), (1001, 1000 * _rate(1.001, step_s)))
    # The quotient of two whole numbers is the float nearest to it.
    steps = [duration / count for duration, count in rates if count]
    near = min(steps, key=lambda step: abs(step - step_s), default=step_s)
    return near if abs(near - step_s) <= _rounding(step_s) else step_s


def _rate(duration_s: float, step_s: float) -> int:
    """The usual number of steps that is nearest to how many a duration has; 0 for none."""
    steps = duration_s / step_s
    return round(steps) if steps < _RATES + 0.5 else 0


def _rounding(step_s: float) -> float:
    """By how much a step (s) may differ from what it stands for, as it is written."""
    noise = _NOISE * math.ulp(step_s)
    written = Decimal(repr(float(step_s))).normalize().as_tuple()
    if len(written.digits) < _FEWEST_DIGITS:
        return noise
    return noise + 0.5 * 10.0 ** int(written.exponent)
