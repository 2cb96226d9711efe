"""A long recording is looked at in parts, and what is found of it is what it is as a whole."""

from dataclasses import replace

import pytest

from rulec import read_recording
from rulec.api.rulebook_compilation import machines
from rulec.extraction import recording_parts as parting
from rulec.extraction.recording_parts import looked_at
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.tracks.source_tolerances import tolerances_of
from rulec.extraction.traffic_thresholds import USUAL
from rulec.extraction.violation_evidence import evidence_of
from rulec.monitoring.explain.explanation import explain
from rulec.recordings.recording import StatedError
from rulec.recordings.track import Track, TrackOutlines, TrackStates
from rulec.report.findings.findings_of_drives import DriveFindings
from support.builders.recordings import recording, straight, vehicle
from support.worlds.stored import StoredWorld

APART = 120.0
"""Seconds from one copy of a world to the next, which begins before the last one is over."""


def later(body, steps, copy):
    """The same participant so many steps later, by another name."""
    track = body.states.track
    moved = Track(track.steps + steps, track.rows, track.length, track.width)
    lamps = {step + steps: lit for step, lit in body.lamps.items()}
    return replace(
        body,
        id=f"{body.id}_{copy}",
        states=TrackStates(moved),
        outlines=TrackOutlines(moved),
        lamps=lamps,
    )


@pytest.fixture(scope="module")
def long_recording():
    """A world three times, so that many are never there together."""
    world = StoredWorld("grid")
    once = read_recording(world.data, world.net)
    steps = round(APART / once.step_s)
    bodies = [
        later(body, steps * copy, copy) for copy in range(3) for body in once.participants[:4]
    ]
    return replace(once, participants=tuple(bodies))


@pytest.fixture(scope="module")
def rules():
    return machines("de")


def found_in(long, rules, most, monkeypatch):
    """What is found in parts of so many cells, and the number of these."""
    monkeypatch.setattr(parting, "MOST_CELLS", most)
    monkeypatch.setattr(parting, "MOST_TIMES_ALONE", 0)
    verdicts = RecordingVerdicts(long, rules, RequestedDrives(), "some.xml")
    findings = DriveFindings(verdicts, "some.xml")
    told = [
        (findings.add(one), getattr(getattr(one, "drive", None), "arrays", one))
        for one in verdicts.answers()
    ]
    return told, findings.whole(), len(verdicts.drives.parts)


def test_findings_are_those_of_the_whole(long_recording, rules, monkeypatch):
    usual = found_in(long_recording, rules, 1 << 30, monkeypatch)
    assert usual[2] == 1
    assert any(one.outcome == "violated" for one in usual[1].findings)
    for most, least in ((1, 12), (4_000, 3)):
        told, whole, parts = found_in(long_recording, rules, most, monkeypatch)
        assert parts >= least
        assert (told, whole) == usual[:2]


def test_a_part_has_all_who_are_there_meanwhile(monkeypatch):
    monkeypatch.setattr(parting, "MOST_CELLS", 1)
    monkeypatch.setattr(parting, "MOST_TIMES_ALONE", 0)
    spans = {"a": (0, 10), "b": (5, 90), "c": (300, 310), "d": (300, 301)}
    bodies = [
        vehicle(name, {step: (step, 0.0) for step in range(first, last + 1)})
        for name, (first, last) in spans.items()
    ]
    bodies.append(replace(vehicle("still", {0: (9.0, 9.0)}), standing=True))
    bodies[3] = replace(bodies[3], stated_error=StatedError(0.6, 0.7))
    whole = recording([straight(1, -10, 400)], bodies, step_s=1.0)
    parts = parting.recording_parts(whole, parting.egos_of(whole), USUAL)
    assert [part.egos for part in parts] == [("a",), ("b",), ("c",), ("d",)]
    there = [[body.id for body in part.recording.participants] for part in parts]
    together, later_ones = ["a", "b", "still"], ["c", "d", "still"]
    assert there == [together, together, later_ones, later_ones]
    # What is said of the whole recording is known in all parts, and where these end
    assert [tolerances_of(part.recording) for part in parts] == 4 * [tolerances_of(whole)]
    assert [looked_at(part.recording) for part in parts] == [
        (0, 91),
        (0, 91),
        (299, 310),
        (299, 310),
    ]
    assert looked_at(whole) == (0, 310)


def test_vehicles_share_a_part_as_long_as_it_is_small(monkeypatch):
    monkeypatch.setattr(parting, "MOST_CELLS", 450)
    bodies = [
        vehicle(n, {step: (step, 0.0) for step in range(100 * n, 100 * n + 11)}) for n in range(6)
    ]
    whole = recording([straight(1, -10, 700)], bodies, step_s=1.0)
    parts = parting.recording_parts(whole, parting.egos_of(whole), USUAL)
    # Three take 3 * 211 cells with those between, two 2 * 111
    assert [part.egos for part in parts] == [("0", "1"), ("2", "3"), ("4", "5")]


def test_a_crowd_is_not_looked_at_anew_for_each_of_its_drives(monkeypatch):
    monkeypatch.setattr(parting, "MOST_CELLS", 1)
    # Ten are there together for 100 s, ten more an hour later; each needs the nine beside it
    firsts = {f"{letter}{n}": 3600 * (letter == "b") + n for letter in "ab" for n in range(10)}
    bodies = [
        vehicle(name, {step: (step - first, 0.0) for step in range(first, first + 101)})
        for name, first in firsts.items()
    ]
    whole = recording([straight(1, -10, 400)], bodies, step_s=1.0)
    parts = parting.recording_parts(whole, parting.egos_of(whole), USUAL)
    assert [part.egos for part in parts] == [tuple(firsts)[:10], tuple(firsts)[10:]]
    assert [[body.id for body in part.recording.participants] for part in parts] == [
        list(part.egos) for part in parts
    ]


def test_evidence_needs_only_what_the_rule_reads(rules):
    world = StoredWorld("priority")
    verdicts = RecordingVerdicts(
        read_recording(world.data, world.net), rules, RequestedDrives(), "some.xml"
    )
    looked = 0
    for one in verdicts.answers():
        for violation in getattr(getattr(one, "answer", None), "violations", ()):
            drive, rules = one.drive, verdicts.rules
            whole = explain(violation, drive.trace, rules, drive.decided_by, repaired=False)
            own = evidence_of(violation, drive, rules, {})
            assert own == evidence_of(violation, drive, rules, {}, whole)
            looked += 1
    assert looked >= 3
