"""Recordings are read with the numbers of the rulebook's law."""

import pytest

from rulec import RequestedDrives, Thresholds, compile_rulebook, parse_rulebook, verify_recording
from support.builders.drive_contexts import steady
from support.builders.recordings import recording
from support.generators.random_recordings import lanes

BOOK = """rulebook own
traffic right
use road
{}
hard rule keeps(v: vehicle) {{ require always (behind(v) and same_lane(v) implies safe_gap(v)) }}
hard rule slow {{ require always can_stop_at_once }}
"""


def broken(lines, **thresholds):
    """The rules that ego breaks: 20 m behind the next one, both at 36 km/h, for twenty steps."""
    drives = recording(lanes(1), [steady(7, 0, 0, speed=10.0), steady(8, 24.5, 0, speed=10.0)])
    book = compile_rulebook(parse_rulebook(BOOK.format(lines)))
    wanted = RequestedDrives("7", Thresholds(**thresholds))
    (answer,) = verify_recording(drives, book, wanted).answers()
    return {violation.rule for violation in answer.answer.violations}


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        # Both brake alike, so that the way while reacting counts: 10 m/s for that long
        ("", {"slow"}),
        ("set reaction_time = 1.5 s", {"slow"}),
        ("set reaction_time = 3 s", {"slow", "keeps"}),
        # Ego brakes from 10 m/s in 6.25 m, the other one likewise, whatever all can brake
        ("set full_braking = 2 m/s^2", {"slow"}),
        ("set speed_to_stop_at_once = 40 km/h", set()),
    ],
)
def test_a_book_sets_the_numbers_of_words(lines, expected):
    assert broken(lines) == expected


def test_who_chooses_a_threshold_is_heard():
    assert "keeps" in broken("", reaction_s=3.0)
    assert "keeps" not in broken("set reaction_time = 3 s", reaction_s=0.5)
