"""What drives are judged by, most maneuvers are judged by, too."""

import pytest

from rulec.api.rulebook_compilation import machines
from support.builders.recorded_data import RECORDINGS
from support.oracles.judged_pairs import judged_pairs

FILES = sorted(RECORDINGS.glob("*.xml"))
LEAST = 0.6


@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize("book", [pytest.param("de", marks=pytest.mark.long)])
def test_of_all_recordings(book):
    rules = machines(book)
    found = [judged_pairs(file, rules) for file in FILES]
    in_drives = sum(len(pairs.in_drives) for pairs in found)
    assert in_drives > 100
    assert sum(len(pairs.in_maneuvers) for pairs in found) >= LEAST * in_drives
