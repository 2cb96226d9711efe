"""Rows of numbers that stand one behind the other, each found once."""

from random import Random

import pytest

from rulec.monitoring.uncertainty.state_letters import letter_diagram


@pytest.mark.parametrize(("length", "width"), [(1, 1), (40, 1), (40, 3), (7, 5)])
def test_rows_are_found_and_placed(length, width):
    random = Random(0)
    rows = [tuple(random.randrange(3) for _ in range(width)) for _ in range(length)]
    found, places = letter_diagram._distinct_rows([n for row in rows for n in row], width)
    assert sorted(found) == sorted(set(rows))
    assert [found[place] for place in places] == rows
