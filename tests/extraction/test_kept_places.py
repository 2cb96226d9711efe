"""Places on roads are kept for the drives to come, also where there is room for those of few."""

import pytest

from rulec import compile_rulebook, read_recording, verify_recording
from rulec.extraction import drives
from support.builders.track_tables import HEAD, driving, table, written

LANES = "lane,x,y\n" + "".join(f"{y},{x},{y}\n" for y in (0, 50, 100) for x in (0, 400))
"""Three roads, 50 m apart."""

ROWS = [
    row
    for number in range(15)
    for row in driving(f"c{number:02}", steps=20, start=20 + 10 * number, y=50 * (number % 3))
]
"""Cars that stand in the table, and are judged, on one road after the other."""


@pytest.fixture
def computed(monkeypatch):
    """The sizes of the places that were computed."""
    found = []
    compute = drives.Drives._places_during

    def counted(self, road, egos):
        places = compute(self, road, egos)
        found.append(places.tracks.present.size)
        return places

    monkeypatch.setattr(drives.Drives, "_places_during", counted)
    monkeypatch.setattr(drives, "MOST_PLACES", 1)
    return found


def test_with_room_for_two_roads_of_three_those_are_computed_once(tmp_path, monkeypatch, computed):
    recording = read_recording(written(tmp_path, table(HEAD, *ROWS), LANES))
    rules = compile_rulebook("nl")
    whole = verify_recording(recording, rules).rows()
    assert len(computed) == 3
    monkeypatch.setattr(drives, "MOST_KEPT", sum(computed) - 1)
    computed.clear()
    monkeypatch.setattr(drives, "FEWEST_TOGETHER", 100)
    assert verify_recording(recording, rules).rows() == whole
    # One time for each of two roads, and for each of the five cars on the third.
    assert len(computed) == 7
