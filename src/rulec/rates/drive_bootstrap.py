"""A bootstrap over drives: sums over drives that are drawn again and again.

What one driver does in one drive hangs together, so drives are drawn and not violations: the
cluster bootstrap (Davison and Hinkley, "Bootstrap methods and their application", 1997, § 3.8).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from rulec.rates.exact_intervals import Interval

REPLICATES = 2_000
DRIVES_TOGETHER = 1 << 11
"""Drives whose numbers are added up at a time, so that any number of them takes little memory."""

Sums = NDArray[np.float64]


def bootstrapped(
    n_drives: int, n_columns: int, blocks: Iterable[Sums], seed: int, replicates: int = REPLICATES
) -> Sums:
    """Sums (replicates x columns) over as many drives as there are, drawn with replacement.

    ``blocks`` (drives x columns) are the numbers of ``DRIVES_TOGETHER`` drives each, the last ones
    of fewer. A seed draws the same drives every time.
    """
    chance = np.random.default_rng(seed)
    totals = np.zeros((replicates, n_columns))
    left = np.full(replicates, n_drives, dtype=np.int64)
    rest = n_drives
    for block in blocks:
        size = len(block)
        # So many of the draws that are left fall into this block, and there on any of its drives.
        drawn = chance.binomial(left, size / rest) if size < rest else left
        times = chance.multinomial(drawn, np.full(size, 1 / size))
        totals += times @ block
        left = left - drawn
        rest -= size
    return totals


def percentile_interval(
    least: tuple[Sums, Sums], most: tuple[Sums, Sums], confidence: float
) -> Interval | None:
    """The percentiles of quotients of sums, one for each replicate; None where there are none."""
    tail = 100 * (1 - confidence) / 2
    with np.errstate(all="ignore"):
        lows, highs = least[0] / least[1], most[0] / most[1]
    lows, highs = lows[np.isfinite(lows)], highs[np.isfinite(highs)]
    if not len(lows) or not len(highs):
        return None
    return float(np.percentile(lows, tail)), float(np.percentile(highs, 100 - tail))
