"""More participants at one place than can be there are refused before they are compared."""

import numpy as np
import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.doubts.crowds import refuse_crowd
from rulec.recordings.tracks.track_table import recording_from_columns
from rulec.resource_limits import CROWD

LANES = {"lane": ["r", "r"], "x": [0, 200], "y": [0, 0]}


def crowd(ids, steps, apart_m=0.0, standing=0):
    tracks = {
        "track": np.repeat(np.arange(ids), steps),
        "t": np.tile(np.arange(steps) / 10, ids),
        "x": np.repeat(np.arange(ids) * apart_m, steps),
        "y": np.zeros(ids * steps),
        "standing": np.repeat(np.arange(ids) < standing, steps).astype(int),
    }
    return recording_from_columns(tracks, LANES)


def test_a_crowd_is_refused():
    with pytest.raises(RulecError) as caught:
        refuse_crowd(crowd(500, 50), "some.csv")
    assert "some.csv: 499 others in the same square" in str(caught.value)
    assert "[R0718]" in str(caught.value)


def test_those_who_stand_are_looked_at_beside_each_other_one_too():
    with pytest.raises(RulecError, match="499 others"):
        refuse_crowd(crowd(500, 300, standing=400), "some.csv")


@pytest.mark.parametrize(
    ("ids", "steps", "apart_m"),
    [
        (CROWD.usual + 1, 100, 0.0),  # as many as there may be
        (2000, 20, 5.0),  # on a road
        (450, 4, 0.0),  # too few pairs to take long
    ],
)
def test_others_are_judged(ids, steps, apart_m):
    refuse_crowd(crowd(ids, steps, apart_m), "some.csv")


def test_the_limit_can_be_lifted(monkeypatch):
    monkeypatch.setenv("RULEC_LIMITS", "crowd=499")
    refuse_crowd(crowd(500, 50), "some.csv")
