"""Recordings are read with the numbers of the rulebook's law."""

from dataclasses import replace

import pytest

from rulec import RequestedDrives, Thresholds, compile_rulebook, parse_rulebook, verify_recording
from rulec.extraction.traffic_thresholds import threshold_options
from rulec.extraction.violation_evidence import evidence_of
from support.builders.drive_contexts import steady
from support.builders.recordings import recording, straight
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


def too_slow(lines="", **wanted):
    """The verdict on a car that drives at 36 km/h, where 72 are allowed, with another behind it."""
    cars = [steady(7, 100, 0, 10, 60), steady(8, 85, 0, 10, 60)]
    found = recording([straight(1, 0, 900, limit_mps=20.5)], cars)
    found = replace(found, complete=frozenset(("arrivals", "light", "YIELD")))
    rule = "hard rule flows { require never impedes_traffic }"
    text = f"rulebook own\ntraffic right\nuse road\n{lines}\n{rule}"
    book = compile_rulebook(parse_rulebook(text))
    (answer,) = verify_recording(found, book, RequestedDrives("7", **wanted)).answers()
    return answer, book


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("", True),
        ("set far_below_limit = 0.45", False),
        # 15 m, less the length of a car, are a little more than one second
        ("set following_within = 1 s", False),
        ("set slow_for = 25 s", False),
        ("redefine impedes_traffic = speed < 30 km/h", False),
        ("redefine impedes_traffic = speed < 40 km/h", True),
    ],
)
def test_a_book_says_who_impedes_traffic(lines, expected):
    answer, _ = too_slow(lines)
    assert bool(answer.answer.violations) == expected


def test_a_violation_by_a_defined_word_rests_on_what_that_was_made_of():
    answer, book = too_slow()
    (violation,) = answer.answer.violations
    evidence = evidence_of(violation, answer.drive, book, {})
    assert "impedes_traffic" not in evidence.measured
    assert {"limit", "gap", "oncoming", "ego_type"} <= {*evidence.measured}
    assert evidence.unknown == ("cause_to_brake",)
    assert evidence.rests_on == "measured"
    # Since the first state, after which it has been slow, ten seconds have passed
    assert evidence.at_s == 10.0


def test_a_defined_word_is_none_of_the_defaults():
    """Unknown values are taken as usual, but the word still means what it is defined as."""
    answer, book = too_slow(defaults=True)
    (violation,) = answer.answer.violations
    evidence = evidence_of(violation, answer.drive, book, {})
    assert "limit" in evidence.measured
    assert evidence.rests_on == "measured"


@pytest.mark.parametrize("name", ["accelerating_mps2", "braking_hard_mps2", "stops_at_once_kmh"])
def test_only_a_book_sets_the_numbers_of_definitions(name):
    with pytest.raises(ValueError, match=f"`{name}` is a rulebook's: `set "):
        RequestedDrives("7", Thresholds(**{name: 1.0}))
    with pytest.raises(ValueError, match=f"`{name}` is a rulebook's: `set "):
        threshold_options([f"{name}=1"])
