"""Intervals: numbers from the literature, and coverage in simulation."""

import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import gammaincinv

from rulec.diagnostics import RulecError
from rulec.rates.exact_intervals import (
    DRIVES_TOGETHER,
    ClusterSizes,
    binomial_interval,
    bootstrapped,
    clustered_interval,
    percentile_interval,
    poisson_interval,
)

POISSON = {0: (0.0, 3.689), 1: (0.025, 5.572), 2: (0.242, 7.225), 10: (4.795, 18.390)}
"""Garwood (1936), as in table 1 of Ulm, "Simple method to calculate the confidence interval of a
standardized mortality ratio" (1990)."""

BINOMIAL = {(0, 10): (0.0, 0.3085), (5, 10): (0.1871, 0.8129), (10, 10): (0.6915, 1.0)}
"""Clopper and Pearson (1934); 0.3085 is 1 - 0.025 ** (1 / 10)."""


@pytest.mark.parametrize("count", POISSON)
def test_poisson(count):
    assert poisson_interval(count, count, 0.95) == pytest.approx(POISSON[count], abs=6e-4)


@pytest.mark.parametrize("counts", BINOMIAL)
def test_clopper_pearson(counts):
    assert binomial_interval(counts, counts, 0.95) == pytest.approx(BINOMIAL[counts], abs=6e-5)


def test_what_is_open_widens_an_interval():
    low, high = poisson_interval(1, 10, 0.95)
    assert (low, high) == (poisson_interval(1, 1, 0.95)[0], poisson_interval(10, 10, 0.95)[1])
    assert binomial_interval((0, 12), (5, 10), 0.95) == pytest.approx((0.0, 0.8129), abs=6e-5)


def test_without_the_package_its_name_is_said(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(RulecError) as refused:
        poisson_interval(1, 1, 0.95)
    (told,) = refused.value.diagnostics
    assert told.code == "R0717"
    assert "[rates]'`" in told.help


def test_without_trials_nothing_is_known():
    assert binomial_interval((0, 0), (0, 0), 0.95) == (0.0, 1.0)


@pytest.mark.parametrize(("trials", "probability"), [(20, 0.05), (50, 0.3), (400, 0.01)])
def test_clopper_pearson_covers_independent_opportunities(trials, probability):
    counts = np.random.default_rng(1).binomial(trials, probability, 4_000)
    held = {
        k: covers(binomial_interval((k, trials), (k, trials), 0.95), probability)
        for k in set(counts)
    }
    assert np.mean([held[k] for k in counts]) >= 0.95


@pytest.mark.parametrize("expected", [0.5, 3.0, 40.0])
def test_poisson_covers_independent_violations(expected):
    counts = np.random.default_rng(2).poisson(expected, 4_000)
    held = {k: covers(poisson_interval(int(k), int(k), 0.95), expected) for k in set(counts)}
    assert np.mean([held[k] for k in counts]) >= 0.95


def covers(interval, value):
    return interval[0] <= value <= interval[1]


def simulated(chance, n_drives):
    """Drives of 20 opportunities each; one driver of five violates a third of them."""
    reckless = chance.random(n_drives) < 0.2
    violated = chance.binomial(20, np.where(reckless, 1 / 3, 0.0))
    return np.stack([violated, np.full(n_drives, 20)], axis=1).astype(float)


def test_only_the_bootstrap_covers_violations_of_few_drivers():
    """The exact interval takes those of one driver for independent, and is far too narrow."""
    chance, n_drives, truth = np.random.default_rng(3), 100, 0.2 / 3
    exact, over_drives = [], []
    for number in range(400):
        drives = simulated(chance, n_drives)
        violated, trials = (int(total) for total in drives.sum(axis=0))
        exact.append(covers(binomial_interval((violated, trials), (violated, trials), 0.95), truth))
        drawn = bootstrapped(n_drives, 2, [drives], number, replicates=500)
        interval = percentile_interval((drawn[:, 0], drawn[:, 1]), (drawn[:, 0], drawn[:, 1]), 0.95)
        over_drives.append(covers(interval, truth))
    assert 0.91 <= np.mean(over_drives) <= 0.98
    assert np.mean(exact) < 0.75


@pytest.mark.parametrize(
    ("n_drives", "reckless", "part"),
    [(100, 0.03, 1 / 3), (100, 0.03, 0.9), (300, 0.01, 0.5), (20, 0.5, 0.5), (12, 0.3, 0.3)],
)
def test_that_of_clusters_covers_violations_of_very_few_drivers(n_drives, reckless, part):
    """Some three drivers do it all, in some samples none; the others never do."""
    chance = np.random.default_rng(7)
    drives = chance.random((600, n_drives)) < reckless
    violated = chance.binomial(20, np.where(drives, part, 0.0))
    expected = n_drives * 20 * reckless * part
    held = []
    for each in violated.astype(float):
        sizes = ClusterSizes(each.sum(), (each**2).sum())
        held.append(covers(clustered_interval(sizes, sizes, 20.0, 0.95), expected))
    # 600 samples of something that is covered 95 times of 100 have a deviation of 0.009.
    assert np.mean(held) >= 0.95


def test_that_of_clusters_covers_drives_of_all_lengths_and_careless_ones():
    """Nearly all do it once in a while, three of a hundred half of the time."""
    chance = np.random.default_rng(8)
    held = []
    for _ in range(600):
        opportunities = 1 + chance.geometric(1 / 20, 100)
        rates = np.where(chance.random(100) < 0.03, 0.5, 0.01)
        violated = chance.binomial(opportunities, rates).astype(float)
        sizes = ClusterSizes(violated.sum(), (violated**2).sum())
        low, high = clustered_interval(sizes, sizes, opportunities.max(), 0.95)
        truth = (0.03 * 0.5 + 0.97 * 0.01) * opportunities.sum()
        held.append(low <= truth <= high)
    assert np.mean(held) >= 0.95


@given(st.integers(0, 50), st.integers(0, 10), st.sampled_from([0.5, 0.9, 0.95]))
def test_clusters_of_one_are_independent(least, more, confidence):
    most = least + more
    sizes = [ClusterSizes(n, n) for n in (least, most)]
    assert clustered_interval(*sizes, 1.0, confidence) == pytest.approx(
        poisson_interval(least, most, confidence)
    )


def test_clusters_by_hand():
    """Two drives of 3 and 4 violations, of at most 5 opportunities: gammas of 49/25 and 144/50
    events of 25/7 and 50/12 each (Fay and Feuer's formulas), whose quantiles scipy has."""
    sizes = ClusterSizes(7.0, 25.0)
    low, high = clustered_interval(sizes, sizes, 5.0, 0.95)
    assert low == pytest.approx(gammaincinv(49 / 25, 0.025) * 25 / 7)
    assert high == pytest.approx(gammaincinv(144 / 50, 0.975) * 50 / 12)


def test_drives_are_drawn_alike_whatever_blocks_they_come_in():
    """As many drives are drawn as there are, each as often as any other on average."""
    values = np.arange(60, dtype=float).reshape(30, 2)
    values[:, 1] = 1.0
    for blocks in ([values], [values[:7], values[7:8], values[8:]]):
        drawn = bootstrapped(30, 2, blocks, 4, replicates=4_000)
        assert (drawn[:, 1] == 30).all()
        # The standard error of the mean of 4,000 sums of 30 values with a deviation of 17.3.
        assert drawn[:, 0].mean() == pytest.approx(values[:, 0].sum(), abs=4 * 1.5)
        assert drawn[:, 0].std() == pytest.approx(values[:, 0].std() * 30**0.5, rel=0.05)


def test_a_seed_draws_the_same_drives():
    values = np.arange(2.0 * DRIVES_TOGETHER).reshape(-1, 1)
    blocks = [values[:DRIVES_TOGETHER], values[DRIVES_TOGETHER:]]
    once, again, other = (bootstrapped(len(values), 1, blocks, seed, 20) for seed in (5, 5, 6))
    assert (once == again).all()
    assert (once != other).any()


def test_without_anything_to_divide_by_there_is_no_interval():
    nothing = np.zeros(10)
    assert percentile_interval((nothing, nothing), (nothing, nothing), 0.95) is None
