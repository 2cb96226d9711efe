"""A bootstrap over drives: sums over drives resampled with replacement.

Violations within a drive depend on each other, so drives are resampled and not violations: the
cluster bootstrap (Davison and Hinkley, "Bootstrap methods and their application", 1997, § 3.8).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from rulec.rates.exact_intervals import Interval

REPLICATES = 2_000
DRIVES_TOGETHER = 1 << 11
"""Number of drives summed at a time, so that any number of drives takes little memory."""

Sums = NDArray[np.float64]


def bootstrapped(
    n_drives: int, n_columns: int, blocks: Iterable[Sums], seed: int, replicates: int = REPLICATES
) -> Sums:
    """Sums (replicates x columns) over ``n_drives`` drives, drawn with replacement.

    ``blocks`` (drives x columns) are the values of ``DRIVES_TOGETHER`` drives each, the last block
    of fewer. The same seed always draws the same drives.
    """
    chance = np.random.default_rng(seed)
    totals = np.zeros((replicates, n_columns))
    left = np.full(replicates, n_drives, dtype=np.int64)
    rest = n_drives
    for block in blocks:
        size = len(block)
        # This many of the remaining draws fall into this block, each on any of its drives alike.
        drawn = chance.binomial(left, size / rest) if size < rest else left
        times = chance.multinomial(drawn, np.full(size, 1 / size))
        totals += times @ block
        left = left - drawn
        rest -= size
    return totals


def percentile_interval(
    least: tuple[Sums, Sums], most: tuple[Sums, Sums], confidence: float
) -> Interval | None:
    """The percentile interval of the ratios of sums over all replicates; None if none is finite.

    ``least`` and ``most`` are pairs of numerator and denominator for the lower and the upper end.
    """
    tail = 100 * (1 - confidence) / 2
    with np.errstate(all="ignore"):
        lows, highs = least[0] / least[1], most[0] / most[1]
    lows, highs = lows[np.isfinite(lows)], highs[np.isfinite(highs)]
    if not len(lows) or not len(highs):
        return None
    return float(np.percentile(lows, tail)), float(np.percentile(highs, 100 - tail))
