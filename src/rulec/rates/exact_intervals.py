"""Intervals of counts: of independent events, and of events that come in clusters.

The Poisson and binomial intervals have at least their nominal confidence if events are independent.
Sources: Garwood, "Fiducial limits for the Poisson distribution" (1936); Clopper and Pearson, "The
use of confidence or fiducial limits illustrated in the case of the binomial" (1934). The interval
for clusters follows Fay and Feuer, "Confidence intervals for directly standardized rates: a method
based on the gamma distribution" (1997).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

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
    high = (
        1.0
        if k_most >= n_most
        else float(special.betaincinv(k_most + 1, n_most - k_most, 1 - tail))
    )
    return low, high


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
