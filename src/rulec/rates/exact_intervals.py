"""Intervals of counts: of independent events, and of events that come in clusters.

The Poisson and binomial intervals have at least their nominal confidence if events are independent.
Sources: Garwood, "Fiducial limits for the Poisson distribution" (1936); Clopper and Pearson, "The
use of confidence or fiducial limits illustrated in the case of the binomial" (1934). The interval
for clusters follows Fay and Feuer, "Confidence intervals for directly standardized rates: a method
based on the gamma distribution" (1997).

Violations within a drive depend on each other, so drives are resampled and not violations: the
cluster bootstrap (Davison and Hinkley, "Bootstrap methods and their application", 1997, § 3.8).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.rates.rates_messages import no_scipy

Interval = tuple[float, float]


def poisson_interval(least: int, most: int, confidence: float) -> Interval:
    """Interval of the expected number of events when ``least`` to ``most`` events were counted.

    Raises RulecError R0717 without scipy.
    """
    special = _special()
    tail = (1 - confidence) / 2
    low = float(special.gammaincinv(least, tail)) if least else 0.0
    return low, float(special.gammainccinv(most + 1, tail))


def binomial_interval(least: tuple[int, int], most: tuple[int, int], confidence: float) -> Interval:
    """Interval of a probability, from pairs (successes, trials) for its lower and its upper end.

    Without trials it is 0 to 1. Raises RulecError R0717 without scipy.
    """
    special = _special()
    tail = (1 - confidence) / 2
    (k, n), (k_most, n_most) = least, most
    low = float(special.betaincinv(k, n - k + 1, tail)) if k else 0.0
    if k_most >= n_most:
        return low, 1.0
    return low, float(special.betaincinv(k_most + 1, n_most - k_most, 1 - tail))


@dataclass(frozen=True, slots=True)
class ClusterSizes:
    """The total number of events in all clusters, and the sum of the squared cluster sizes."""

    total: float
    squares: float


def clustered_interval(
    least: ClusterSizes, most: ClusterSizes, largest: float, confidence: float
) -> Interval:
    """Interval of the expected number of events in independent clusters of at most ``largest``.

    A sum of Poisson counts, each weighted by its cluster's size; the upper end assumes that one
    more cluster of the largest size was missed. If each cluster has one event, it is the Poisson
    interval. Raises RulecError R0717 without scipy.
    """
    special = _special()
    tail = (1 - confidence) / 2
    low = 0.0
    if least.total:
        low = float(special.gammaincinv(least.total**2 / least.squares, tail))
        low *= least.squares / least.total
    largest = max(largest, 1.0)
    total, squares = most.total + largest, most.squares + largest**2
    return low, float(special.gammainccinv(total**2 / squares, tail)) * squares / total


def _special() -> Any:
    try:
        from scipy import special  # an extra, and 0.2 s
    except ImportError:
        raise no_scipy() from None
    return special


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
