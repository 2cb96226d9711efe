"""Equal rows are found by one number each, or, where that gets too large, row by row."""

import numpy as np
import pytest

from rulec.monitoring.uncertainty.state_letters import letter_diagram


@pytest.mark.parametrize("most", [1 << 18, 1])
@pytest.mark.parametrize("shape", [(1, 1), (40, 1), (40, 3), (7, 5)])
def test_rows_are_found_and_placed(monkeypatch, most, shape):
    monkeypatch.setattr(letter_diagram, "MOST_STEPS", most)
    rows = np.random.default_rng(0).integers(0, 3, shape)
    found, places = letter_diagram._distinct_rows(rows)
    assert found.tolist() == [list(row) for row in sorted(set(map(tuple, rows.tolist())))]
    assert (found[places] == rows).all()
