"""Headings that are known badly: a bus passes a cyclist with enough room, or with too little."""

import numpy as np
import pytest

import rulec
from rulec.extraction.drives import Drives
from rulec.extraction.recording_parts import whole_recording
from rulec.extraction.tracks.heading_errors import heading_errors
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from rulec.vocabulary.partial_values import UNKNOWN

STEP_S = 0.1
WORDS = ("driving_side", "reversing")
KINDS = {"limit_mps": 13.89, "types": ("urban",), "left_mark": "broken", "right_mark": "solid"}
LANES = [
    rulec.build_lanelet("on", [(-10, 0), (300, 0)], **KINDS),
    rulec.build_lanelet("back", [(300, 3.5), (-10, 3.5)], **KINDS),
]


def of_motion(x, y):
    """The direction of the way onward from each place."""
    return np.arctan2(np.diff(y, append=y[-1]), np.diff(x, append=x[-1] + 1.0))


def passing(room_m, pick, noise_deg=0.0, noise_m=0.0, headings="stated"):
    """The bus at 10 m/s with so much room beside the cyclist at 4.5 m/s."""
    t = np.arange(0, 14.05, STEP_S)
    bodies = []
    for name, kind, x, y, size in (
        ("cyclist", "bicycle", 48.5 + 4.5 * t, -1.2, (1.8, 0.65)),
        ("bus", "bus", 10.0 + 10.0 * t, -1.2 + 0.325 + room_m + 1.275, (12.0, 2.55)),
    ):
        x = x + pick.normal(scale=noise_m, size=len(t))
        y = y + pick.normal(scale=noise_m, size=len(t))
        heading = np.radians(pick.normal(scale=noise_deg, size=len(t)))
        given = {"stated": heading, "of motion": of_motion(x, y), "none": None}[headings]
        length, width = size
        more = {"step_s": STEP_S, "length": length, "width": width, "heading": given}
        bodies.append(rulec.build_participant(name, kind, t, x, y, **more))
    return rulec.build_recording(LANES, bodies, step_s=STEP_S, side="right")


def verdict(recording, book, rule="lateral_gap"):
    wanted = rulec.RequestedDrives(egos=("bus",), assumed={"built_up": True})
    (drive,) = rulec.verify_recording(recording, rulec.compile_rulebook(book), wanted=wanted)
    if rule in {violation.rule for violation in drive.answer.violations}:
        return "violated"
    return "open" if rule in {part.rule for part in drive.answer.open} else "kept"


@pytest.mark.parametrize(
    "noise",
    [{"noise_deg": 3.0}, {"noise_m": 0.05, "headings": "of motion"}],
    ids=["white", "of motion"],
)
def test_noise_of_headings_accuses_nobody_and_hides_no_offender(noise):
    pick = np.random.default_rng(4)
    assert {verdict(passing(1.9, pick, **noise), "de") for _ in range(4)} == {"open"}
    assert {verdict(passing(1.1, pick, **noise), "de") for _ in range(4)} == {"violated"}


def test_headings_without_noise_leave_nothing_open():
    pick = np.random.default_rng(4)
    assert [verdict(passing(room, pick), "de") for room in (1.58, 1.42)] == ["kept", "violated"]


def errors_deg(recording):
    tracks = tracks_of(recording, USUAL)
    found = heading_errors(tracks, whole_recording(recording), recording.step_s)
    return np.degrees(np.where(tracks.present, found, np.nan))[1]


def test_noise_shows_in_the_differences_of_headings():
    found = errors_deg(passing(1.9, np.random.default_rng(1), noise_deg=3.0))
    assert (np.abs(found - 12.0) < 4.0).all()
    assert errors_deg(passing(1.9, np.random.default_rng(1))).max() < 0.01


@pytest.mark.parametrize("headings", ["of motion", "none"])
def test_a_direction_of_motion_is_as_wrong_as_its_places_over_its_way(headings):
    # Places 1 m apart have differences of 0.07 m across: four degrees, four times
    found = errors_deg(passing(1.9, np.random.default_rng(1), noise_m=0.05, headings=headings))
    assert 12.0 < np.median(found) < 26.0


def test_a_turning_vehicle_shows_no_noise():
    t = np.arange(0, 12.05, STEP_S)
    angle = 0.5 * np.sin(t)
    x, y = (np.cumsum(6.0 * STEP_S * way(angle)) for way in (np.cos, np.sin))
    more = {"step_s": STEP_S, "heading": angle}
    bodies = [rulec.build_participant(name, "car", t, x, y, **more) for name in ("a", "b")]
    recording = rulec.build_recording(LANES, bodies, step_s=STEP_S, side="right")
    assert errors_deg(recording).max() < 0.5


def backing(headings, mps=-2.4):
    """A car that stands in its lane, backs in it, stands and drives on."""
    t = np.arange(0, 16.05, STEP_S)
    speed = np.interp(t, [0, 3, 4, 8, 9, 12, 15], [0, 0, mps, mps, 0, 0, 6])
    x = 150 + np.append(0, np.cumsum((speed[1:] + speed[:-1]) / 2 * STEP_S))
    ways = np.where(speed < 0, np.pi, 0.0)
    given = {"stated": np.zeros(len(t)), "of motion": ways, "none": None}[headings]
    body = rulec.build_participant("a", "car", t, x, np.zeros(len(t)), step_s=STEP_S, heading=given)
    return rulec.build_recording(LANES, [body], step_s=STEP_S, side="right")


def sides_and_backing(recording):
    """The values that these words have while ego moves back."""
    return {
        tuple(None if state[word] is UNKNOWN else state[word] for word in WORDS)
        for drive in Drives(recording, "right").of("a")
        for at, state in enumerate(drive.trace.states)
        if 4.5 <= drive.start_s + at * STEP_S <= 7.5
    }


@pytest.mark.parametrize(
    ("headings", "found"),
    [("stated", ("own_side", True)), ("of motion", (None, None)), ("none", (None, None))],
)
def test_directions_of_motion_do_not_tell_who_backs_from_who_drives_against(headings, found):
    assert sides_and_backing(backing(headings)) == {found}


@pytest.mark.parametrize("headings", ["of motion", "none"])
def test_nobody_backs_fast(headings):
    assert sides_and_backing(backing(headings, mps=-9.0)) == {("oncoming_side", False)}
