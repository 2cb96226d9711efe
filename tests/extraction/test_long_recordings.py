"""Of a long recording only a part is looked at at a time, which changes nothing."""

from hypothesis import given

from rulec.extraction import drives
from rulec.extraction.drives import Drives
from support.generators.random_recordings import scenes


def told(found):
    drives = Drives(found, "right")
    return [one for ego in drives.egos() for one in drives.of(ego)]


@given(scenes())
def test_a_part_at_a_time(found):
    usual, most = told(found), drives.MOST_PLACES
    drives.MOST_PLACES = 0
    try:
        assert told(found) == usual
    finally:
        drives.MOST_PLACES = most
