"""Which piece of a line a place is in is looked up, and is the one that a search finds."""

import numpy as np
import pytest

from rulec.scenario.recorded.borders import Borders


def searched(borders, places):
    return np.maximum(np.searchsorted(borders, places, side="right") - 1, 0)


def lines(chance):
    """Gaps between borders: alike, of any length, with some that are tiny, and very different."""
    count = int(chance.integers(2, 120))
    yield np.full(count, 4.9)
    yield chance.uniform(0.05, 5.0, count)
    yield np.where(chance.random(count) < 0.2, 0.011, 1.0)
    yield chance.exponential(2.0, count) ** 4 + 1e-6


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("beyond_m", [0.0, 2000.0])
def test_places_are_where_a_search_finds_them(seed, beyond_m):
    chance = np.random.default_rng(seed)
    for gaps in lines(chance):
        gaps[[0, -1]] += beyond_m
        borders = np.cumsum(gaps) - 100 * chance.random()
        just = [np.nextafter(borders, end) for end in (-np.inf, np.inf)]
        anywhere = chance.uniform(borders[0] - 50, borders[-1] + 50, 300)
        places = np.concatenate((borders, *just, anywhere, [-1e12, 1e12]))
        found = Borders(borders).before(places)
        assert found.tolist() == searched(borders, places).tolist()


def test_a_table_is_used_where_borders_are_far_enough_apart():
    alike, crowded = np.arange(50.0), np.append(np.arange(50.0), 50 + np.arange(50) * 1e-4)
    assert Borders(alike)._cells is not None
    assert Borders(crowded)._cells is None


def test_a_place_that_is_not_known_is_somewhere():
    borders = Borders(np.arange(50.0))
    assert 0 <= int(borders.before(np.array([np.nan]))[0]) < 50
