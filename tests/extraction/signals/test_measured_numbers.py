"""The bounds of measured numbers, by the tolerances of their source."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.signals import ego_signals
from rulec.extraction.signals.map import lanes_ahead
from rulec.extraction.signals.measured_numbers import LONGEST_S
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import bounded, bounds_of, values_of
from support.words import words_of

NGSIM, SUMO = {"name": "USA_US101"}, {"form": "SUMO data"}


def seen(*bodies, source=NGSIM, limit_mps=None):
    """The context of the first of the bodies on a road of two lanes, from a source."""
    found = recording(lanes(2, limit_mps=limit_mps), bodies)
    return context_of(replace(found, **source))


def speeds(mps, **more):
    """The bounds of the speed of a vehicle at constant speed, by state."""
    low, high = bounds_of(words_of(ego_signals)(seen(steady(7, 0, 0, mps), **more)), "speed")
    return list(zip(low.tolist(), high.tolist(), strict=True))


def to_other(name, *, mps=10.0, x=30, y=0):
    """The bounds of a number about one that stands, in the second state."""
    bounds = bounded(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
            seen(steady(7, 0, 0, mps), steady(8, x + mps / 2, y, 0))
        )
    )
    return tuple(float(end[1]) for end in bounds[name])


def test_speeds_are_means_over_a_second_or_over_half_a_one_at_the_ends():
    # 0.3 m/s are 1.08 km/h; over half a second they are known half as well
    inside, at_ends = (34.92, 37.08), (33.84, 38.16)
    assert speeds(10) == [at_ends, inside, inside, at_ends]


def test_at_the_ends_a_change_of_speed_shows_half_a_window_later():
    # 4 m/s² from 10 m/s on: the mean of the first half second is 11 m/s. 0.6 m/s are its error,
    # and 4 m/s² for a quarter of a second 1 m/s.
    ego = vehicle(7, {k: (10 * t + 2 * t * t, 0) for k in range(5) for t in [k / 2]})
    low, high = bounds_of(words_of(ego_signals)(seen(ego)), "speed")
    assert low[0] <= 36.0 <= high[0]
    assert low[2] == pytest.approx((14 - 0.3) * 3.6, abs=0.011)


def braking_to_14_mps(at):
    """From 20 m/s with 5 m/s², until it gets to a place: where its middle is every 0.1 s."""
    begins = 59.6 + at - 100
    for t in np.arange(0, 4, 0.1):
        u, w = np.clip(t - 1.0, 0, 1.2), max(t - 2.2, 0.0)
        yield begins + 20 * min(t, 1.0) + 20 * u - 2.5 * u * u + 14 * w


@pytest.mark.parametrize(("at", "is_faster"), [(100, False), (125, True)])
def test_who_brakes_until_a_lower_limit_begins_keeps_it(at, is_faster):
    # There the mean over a second is 14.6 m/s, and 0.1 m/s is its error
    road = [
        straight(1, 0, 100, successors=(2,), limit_mps=20.0),
        straight(2, 100, 300, predecessors=(1,), limit_mps=14.0),
    ]
    ego = vehicle(7, {k: (x, 0.0) for k, x in enumerate(braking_to_14_mps(at))})
    context = context_of(recording(road, [ego], step_s=0.1), ("1", "2"))
    low, _ = bounds_of(words_of(ego_signals)(context), "speed")
    beyond = context.limit_mps == 14.0
    assert (low[beyond] > 14.0 * 3.6).any() == is_faster


@pytest.mark.parametrize("step_s", [0.1, 0.2, 0.3])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_stop_or_peak_that_is_shorter_than_the_mean(sign, step_s):
    """From or to 30 m/s, for no longer than a moment at 3 s, with 4 m/s² and 2 m/s²."""
    times = np.arange(0, 6.01, step_s)
    gained = np.where(times < 3, 4, 2) * sign
    from_s, least = times - 3, 0 if sign > 0 else 30
    xs = 90 + least * from_s + np.where(times < 3, -1, 1) * gained * from_s**2 / 2
    ego = vehicle(7, {k: (x, 0.0) for k, x in enumerate(xs.tolist())})
    found = replace(recording(lanes(2), [ego], step_s=step_s), form="tracks")
    low, high = bounds_of(words_of(ego_signals)(context_of(found)), "speed")
    true = (least + np.abs(from_s) * gained) * 3.6
    assert (low <= true + 0.01).all()
    assert (true - 0.01 <= high).all()
    # A second away it drives evenly
    even = np.abs(np.abs(from_s) - 1.3) < 0.2
    assert (high[even] - low[even] < 0.8).all()


def test_who_is_slower_than_the_threshold_stands_and_who_is_hardly_faster_may():
    assert speeds(0.2)[1] == (0.0, 0.0)
    assert speeds(0.4)[1] == (0.0, 2.52)
    assert speeds(1.0)[1] == (2.52, 4.68)


def test_a_simulation_is_known_up_to_its_rounding():
    # 13.92 m/s stand for 13.915 to 13.925, 50.094 to 50.13 km/h
    assert speeds(13.92, source=SUMO) == [(50.09, 50.13)] * 4
    assert speeds(13.92, source=SUMO, limit_mps=50 / 3.6) == [(50.09, 50.13)] * 4


def test_a_simulated_driver_at_the_limit_is_at_it():
    # Nets write 13.89 m/s for 50 km/h
    assert speeds(13.89, source=SUMO, limit_mps=50 / 3.6) == [(50.0, 50.0)] * 4
    assert speeds(13.89, source=SUMO)[0] == (49.98, 50.03)
    assert speeds(13.89, limit_mps=50 / 3.6)[1] != (50.0, 50.0)


def test_distances_are_known_as_far_as_places_are():
    assert to_other("gap", x=30) == (25.7, 26.3)
    assert to_other("lateral_gap", y=4) == (1.7, 2.3)
    # Bodies that surely overlap along the road have no gap; that may touch, perhaps
    assert to_other("gap", x=2) == (0.0, 0.0)
    assert to_other("gap", x=4.1) == (0.0, 0.4)


def test_headways_are_quotients_of_what_gaps_and_speeds_may_be():
    # 25.7 m at 10.3 m/s, 26.3 m at 9.7 m/s
    assert to_other("time_headway") == (2.49, 2.72)
    assert to_other("time_headway", mps=0.1) == (LONGEST_S, LONGEST_S)


def test_errors_of_two_speeds_add_up_as_squares():
    bounds = bounded(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
            seen(steady(7, 0, 0, 10), steady(8, 30, 0, 5))
        )
    )
    low, high = (end[1] for end in bounds["speed_difference"])
    wrong = 1.08 * np.sqrt(2)
    assert (low, high) == pytest.approx((18 - wrong, 18 + wrong), abs=0.011)
    # Who stands does so exactly
    assert to_other("speed_difference") == (34.92, 37.08)


@given(st.floats(0, 40), st.floats(-60, 60), st.floats(-6, 6), st.sampled_from([NGSIM, SUMO, {}]))
def test_what_is_measured_lies_within_its_bounds(mps, x, y, source):
    context = seen(steady(7, 0, 0, mps), steady(8, x, y, 8), source=source)
    found = words_of(ego_signals)(context) | words_of(
        participant_signals, participant_conduct, lanes_ahead, following_signals
    )(context)
    for name, (low, high) in bounded(found).items():
        measured = values_of(found, name)
        assert (low - 0.006 <= measured).all(), name
        assert (measured <= high + 0.006).all(), name


def places_by_speed(mps_at, step_s, until_s=8.0):
    """Places along x at each step, by speeds (m/s) at times (s)."""
    t = np.arange(0.0, until_s, 0.01)
    mps = np.interp(t, *zip(*mps_at, strict=True))
    x = np.concatenate(([0.0], ((mps[1:] + mps[:-1]) / 2 * 0.01).cumsum()))
    return {k: (float(x[round(k * step_s / 0.01)]), 0.0) for k in range(int(until_s / step_s))}


@pytest.mark.parametrize(
    ("mps_at", "may_stand"),
    [
        ([(0, 6), (2.6, 1.3), (3.3, 0), (4.0, 1.1), (6, 6)], True),
        ([(0, 6), (3.0, 1.2), (5.0, 1.2), (7, 6)], False),
        ([(0, 6), (3.0, 2.4), (5.0, 2.4), (7, 6)], False),
    ],
    ids=["stops", "creeps on", "drives on"],
)
def test_one_may_stand_between_two_slow_samples(mps_at, may_stand):
    step_s = 0.5
    body = vehicle(7, places_by_speed(mps_at, step_s), speed=6.0)
    low, _ = bounds_of(
        words_of(ego_signals)(context_of(recording(lanes(2), [body], step_s=step_s))), "speed"
    )
    assert (low == 0).any() == may_stand
