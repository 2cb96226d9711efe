"""How well a source knows places and speeds, and what is unknown therefore."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rulec import recordings
from rulec.extraction.signals import ego_signals
from rulec.extraction.signals.conduct import being_overtaken, overtaking_signals
from rulec.extraction.signals.map import lanes_ahead
from rulec.extraction.signals.measured_numbers import speed_bounds
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.tracks.source_tolerances import (
    BY_FORM,
    DRONES,
    NGSIM,
    OTHERS,
    USUAL_ROUNDING,
    rounded_to,
    tolerances_of,
)
from rulec.extraction.traffic_thresholds import USUAL
from rulec.recordings.recording import StatedError
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording, vehicle
from support.defined_words import defined
from support.generators.random_recordings import lanes
from support.signal_arrays import said, unknown_in, values_of
from support.words import words_of


def of_source(name, *bodies, form="CommonRoad scenario", count=2):
    return replace(recording(lanes(count), bodies), name=name, form=form)


@pytest.mark.parametrize(
    ("name", "form", "tolerances"),
    [
        ("USA_US101-4_1_T-1", "CommonRoad scenario", NGSIM),
        ("USA_Lanker-1_3_T-1", "CommonRoad scenario", NGSIM),
        ("ESP_Toledo-11_5_T-1", "CommonRoad scenario", OTHERS),
        ("highD_01", "highD tracks", DRONES),
        ("DR_USA_Intersection_EP0", "INTERACTION tracks", DRONES),
        ("fcd", "SUMO data", rounded_to(USUAL_ROUNDING)),
    ],
)
def test_a_source_is_known_by_its_form_and_where_it_was_made(name, form, tolerances):
    assert tolerances_of(of_source(name, form=form)) == tolerances


@pytest.mark.parametrize("form", sorted(BY_FORM))
def test_a_form_with_tolerances_is_one_that_is_read(form):
    # One that is misspelt would leave its files as exact as those made by hand
    texts = [file.read_text() for file in Path(recordings.__file__).parent.rglob("*.py")]
    named, _, data_set = form.partition(" of ")
    assert any(re.search(rf'"{named}["{{]|"{named} of ', text) for text in texts)
    assert not data_set or any(f'"{data_set}"' in text for text in texts)


def test_what_a_file_says_of_its_errors_counts_if_it_is_more():
    errors = (None, StatedError(0.25, 0.0), StatedError(0.5, 0.25), StatedError(0.75, 0.5))
    bodies = [replace(steady(20 + k, 0, 0), stated_error=one) for k, one in enumerate(errors)]
    # Two places may be wrong by half a metre each
    assert tolerances_of(of_source("DEU_Test", *bodies)) == replace(
        OTHERS, place_m=1.0, speed_mps=0.25
    )
    (good,) = [replace(steady(7, 0, 0), stated_error=StatedError(0.01, 0.0))]
    assert tolerances_of(of_source("DEU_Test", good)) == OTHERS


def test_what_a_user_says_counts_if_it_is_more():
    # Each of two places may be wrong by 0.4 m; OTHERS know speeds to 0.1 m/s
    said = replace(USUAL, place_error_m=0.4, speed_error_mps=0.05)
    assert tolerances_of(of_source("DEU_Test"), said) == replace(OTHERS, place_m=0.8, add_up=True)
    better = replace(USUAL, place_error_m=0.01)
    assert tolerances_of(of_source("USA_US101"), better) == replace(NGSIM, add_up=True)
    said = replace(USUAL, speed_error_mps=0.3)
    found = tolerances_of(of_source("fcd", form="SUMO data"), said)
    assert (found.stated_mps, found.speed_mps) == (0.3, 0.3)
    # Two that drift may be wrong by all of it, each to its side
    assert (found.joint(0.3, 0.4), NGSIM.joint(0.3, 0.4)) == pytest.approx((0.7, 0.5))


@pytest.mark.parametrize(("said", "bounds"), [(0.0, (50.0, 50.0)), (0.3, (48.92, 51.08))])
def test_a_speed_at_the_limit_is_exact_only_where_speeds_are(said, bounds):
    """A simulated driver keeps to a limit exactly; one whose speed may be 0.3 m/s off need not."""
    speed = 50 / 3.6
    road = [replace(lanelet, limit_mps=speed) for lanelet in lanes(1)]
    drives = steady(7, 0, 0, speed=speed, steps=60, step_s=0.1)
    found = replace(recording(road, [drives], step_s=0.1), form="SUMO data")
    low, high = speed_bounds(context_of(found, (road[0].id,), speed_error_mps=said))
    # 0.3 m/s are 1.08 km/h
    assert (low[30], high[30]) == pytest.approx(bounds, abs=0.011)


def noisy(sigma_m, form="SUMO data", step_s=0.1, across_m=None, turned=0.0):
    """The tolerances of a file with three cars, places of which have so much noise.

    Across their way ``across_m`` of it; all is ``turned`` (rad).
    """
    pick, across_m = np.random.default_rng(10).normal, sigma_m if across_m is None else across_m
    cos, sin = np.cos(turned), np.sin(turned)
    bodies = []
    for y in range(3):
        at = [(k + pick(scale=sigma_m), y + pick(scale=across_m)) for k in range(120)]
        places = {k: (a * cos - b * sin, a * sin + b * cos) for k, (a, b) in enumerate(at)}
        bodies.append(vehicle(8 + y, places))
    return tolerances_of(replace(recording(lanes(2), bodies, step_s=step_s), form=form))


def test_noise_that_tracks_show_counts_if_it_is_more():
    # Four times the square root of two of it, that is 0.28 m
    found = noisy(0.05)
    assert found.place_m == pytest.approx(0.28, rel=0.15)
    assert found.speed_mps == found.place_m
    # How exact the speeds are that a file states is another matter
    assert found.stated_mps == rounded_to(USUAL_ROUNDING).stated_mps
    assert noisy(0.05, form="highD tracks").place_m == pytest.approx(0.28, rel=0.15)
    assert noisy(0.03, form="NGSIM tracks") == NGSIM
    assert noisy(0.001) == rounded_to(USUAL_ROUNDING)
    assert noisy(0.05, step_s=0.5).place_m == pytest.approx(0.28, rel=0.15)
    # A second apart they may differ as the cars speed up
    assert noisy(0.05, step_s=1.0) == rounded_to(USUAL_ROUNDING)


def test_smooth_motion_half_a_second_apart_is_no_noise():
    """Who speeds up and slows down by 2 m/s² within 8 s, as in towns."""
    t = np.arange(120) * 0.5
    x = 10 * t + 2 * (8 / (2 * np.pi)) ** 2 * np.sin(2 * np.pi * t / 8)
    drives = vehicle(8, {k: (float(at), 0.0) for k, at in enumerate(x)})
    found = replace(recording(lanes(2), [drives], step_s=0.5), form="CommonRoad scenario")
    assert tolerances_of(found) == OTHERS


@pytest.mark.parametrize("step_s", [0.1, 0.5])
def test_noise_accuses_nobody_who_keeps_to_a_limit(step_s):
    """Some 250 states a drive: with three standard deviations one in three would be accused."""
    speed, pick, accused = 20.0, np.random.default_rng(3), 0
    road = [replace(lanelet, limit_mps=speed) for lanelet in lanes(1)]
    for _ in range(30):
        x = speed * step_s * np.arange(250) + pick.normal(scale=0.1, size=250)
        drives = vehicle(7, {k: (float(at), 0.0) for k, at in enumerate(x)})
        low, _ = speed_bounds(context_of(recording(road, [drives], step_s=step_s), (road[0].id,)))
        accused += bool((low > speed * 3.6 + 0.01).any())
    # One car alone tells its noise to a fifth
    assert accused <= 2


@pytest.mark.parametrize("turned", [0.0, 0.6, np.pi / 2])
@pytest.mark.parametrize(("along_m", "across_m"), [(0.05, 0.05), (0.05, 0.0), (0.0, 0.05)])
def test_which_way_a_road_leads_says_nothing_of_noise(along_m, across_m, turned):
    found = noisy(along_m, across_m=across_m, turned=turned)
    assert found.place_m == pytest.approx(0.28, rel=0.15)


def test_standing_cars_have_their_places_held_and_tell_no_noise():
    rng = np.random.default_rng(5)
    stands = vehicle(8, {k: tuple(rng.normal(scale=0.05, size=2)) for k in range(120)})
    found = replace(recording(lanes(2), [stands], step_s=0.1), form="SUMO data")
    assert tolerances_of(found) == rounded_to(USUAL_ROUNDING)


@pytest.mark.parametrize(
    ("name", "gap_m", "known"),
    [
        ("USA_US101", 18.6, True),
        ("USA_US101", 18.8, False),
        ("ZAM", 20.5, True),
        ("ZAM", 20.4, False),
    ],
)
def test_a_gap_as_near_to_the_safe_one_as_the_source_is_good(name, gap_m, known):
    # At 20 m/s behind one as fast the safe gap is 20 m. It grows by 3.5 m with each m/s of ego's,
    # shrinks by 2.5 m with each of the other's: by 0.3 m/s and 0.3 m, sqrt(1.05² + 0.75² + 0.3²) m,
    # 1.32 m; by 0.1 m/s and 0.05 m, 0.43 m.
    ego, other = steady(7, 0, 0, 20), steady(8, 4 + gap_m, 0, 20)
    found = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(of_source(name, ego, other))
    )
    assert unknown_in(found, "safe_gap")[0, 1] == (not known)


def test_a_speed_near_a_threshold():
    slow, slower = steady(7, 0, 0, speed=5.6), steady(7, 0, 0, speed=5.0)  # 20.2 and 18 km/h
    for name, ego, known in (
        ("USA_US101", slow, False),
        ("ZAM", slow, False),
        ("USA_US101", slower, True),
    ):
        found = defined("can_stop_at_once", of_source(name, ego))
        assert (set(found) == {"?"}) == (not known)
        assert "F" not in found
    simulated = defined("can_stop_at_once", of_source("x", slow, form="SUMO data"))
    assert set(simulated) == {"F"}


def test_a_simulated_change_of_lanes_in_one_step_is_no_speed():
    # 45 km/h, and 4 m sideways in the last step: by places alone 58 km/h
    places = {k: (12.5 * 0.5 * k, 0.0) for k in range(7)} | {7: (12.5 * 3.5, 4.0)}
    found = words_of(ego_signals)(context_of(of_source("x", vehicle(7, places), form="SUMO data")))
    assert values_of(found, "speed") == pytest.approx(np.full(8, 45.0))


def test_time_headway_and_speed_are_of_the_same_speed():
    # Ego leads 0.3 rad across the road: 10 m/s, 9.55 m/s of them along it
    ahead = {k: (10 * np.cos(0.3) * k, 10 * np.sin(0.3) * k - 8) for k in range(4)}
    ego = vehicle(7, {k: (x / 2, y / 2) for k, (x, y) in ahead.items()}, heading=0.3)
    context = context_of(of_source("x", ego, steady(8, 30, 0, 0)))
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context
    )
    headway, gap = (values_of(signals, name)[0] for name in ("time_headway", "gap"))
    speed = values_of(words_of(ego_signals)(context), "speed")
    assert speed == pytest.approx(np.full(4, 36.0), abs=0.01)
    assert headway == pytest.approx(gap / 10, abs=0.01)


@pytest.mark.parametrize(
    ("name", "x", "station", "known"),
    [
        # Both are 4 m long: ego's front is level with the other's rear at x = 4
        ("ZAM", 4.1, "behind", True),
        ("ZAM", 4.04, "behind", False),
        ("ZAM", 3.96, "beside", False),
        ("ZAM", 3.9, "beside", True),
        ("ZAM", -3.96, "beside", False),
        ("ZAM", -4.04, "in_front_of", False),
        ("ZAM", -4.1, "in_front_of", True),
        ("USA_US101", 4.29, "behind", False),
        ("USA_US101", 4.31, "behind", True),
    ],
)
def test_who_is_level_to_within_a_tolerance_has_no_station(name, x, station, known):
    bodies = steady(7, 0, 0), steady(8, x, 4)
    found = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(of_source(name, *bodies))
    )
    # In the second state: whom ego is beside in the first one it may be passing
    assert said(found, "station")[0, 1] == station
    assert unknown_in(found, "station")[0, 1] == (not known)


@pytest.mark.parametrize(
    ("xs", "known"),
    [
        # Ego's front is level with the other's rear at 4; it passes, only the moment is in doubt
        ((4.2, 4.03, 3.97, 3.8), (True, True, True, True)),
        # It is not known whether it ever came beside
        ((4.2, 4.03, 3.97, 4.03, 4.2), (True, False, False, False, True)),
        # What was before, and what comes
        ((4.03, 4.2), (False, True)),
        ((3.8, 3.8, 3.97), (False, True, False)),
    ],
)
def test_who_passes_has_a_station_all_along(xs, known):
    other = vehicle(8, {k: (10.0 * k + x, 4) for k, x in enumerate(xs)}, speed=10.0)
    ego = vehicle(7, {k: (10.0 * k, 0) for k in range(len(xs))}, speed=10.0)
    found = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(of_source("ZAM", ego, other))
    )
    assert tuple(~unknown_in(found, "station")[0]) == known


def test_overtaking_that_hangs_on_a_tolerance_is_unknown():
    # 96 m behind at 9.55 m/s more is 10.05 s; at 9 m/s more it is clearly longer
    for mps, known in ((10.45, False), (11.0, True), (10.0, True)):
        ego, other = steady(7, 0, 4, 20), steady(8, 100, 0, mps)
        context = context_of(of_source("ZAM", ego, other), ("2",))
        found = words_of(overtaking_signals, being_overtaken)(context)
        assert unknown_in(found, "overtaking")[0] == (not known)
        assert values_of(found, "overtaking")[0] == (mps == 10.0)
