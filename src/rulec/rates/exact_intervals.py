"""Intervals of counts: of independent events, and of events that come in clusters.

Poisson's and the binomial one hold at least their confidence if events are independent. Sources:
Garwood, "Fiducial limits for the Poisson distribution" (1936); Clopper and Pearson, "The use of
confidence or fiducial limits illustrated in the case of the binomial" (1934). That of clusters is
due to Fay and Feuer, "Confidence intervals for directly standardized rates: a method based on the
gamma distribution" (1997).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rulec.rates.rates_messages import no_scipy

Interval = tuple[float, float]


def poisson_interval(least: int, most: int, confidence: float) -> Interval:
    """The expected number of events of which between ``least`` and ``most`` were counted.

    Raises RulecError R0717 without scipy.
    """
    special = _special()
    tail = (1 - confidence) / 2
    low = float(special.gammaincinv(least, tail)) if least else 0.0
    return low, float(special.gammainccinv(most + 1, tail))


def binomial_interval(least: tuple[int, int], most: tuple[int, int], confidence: float) -> Interval:
    """The probability of what happened at least and at most so often, each in so many trials.

    Without trials it may be anything. Raises RulecError R0717 without scipy.
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
    """How many events all clusters have, and the sum of the squares of how many each has."""

    total: float
    squares: float


def clustered_interval(
    least: ClusterSizes, most: ClusterSizes, largest: float, confidence: float
) -> Interval:
    """The expected number of events that come in independent clusters of at most ``largest``.

    A sum of Poisson counts, each with its cluster's size as weight; the upper end supposes that one
    more of the largest was missed. Where each cluster has one event it is Poisson's interval.

    Raises RulecError R0717 without scipy.
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
