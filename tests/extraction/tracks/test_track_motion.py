"""Speeds from places, or as stated where the file knows better, and their errors."""

import numpy as np
import pytest

from rulec.extraction.tracks.source_tolerances import OTHERS, Tolerances
from rulec.extraction.tracks.track_motion import Poses, motion_of

EXACT = Tolerances(0.01, 0.01, 0.005)


def motion(x, stated, known=EXACT, steers=True, step_s=0.1):
    """The motion of somebody along the x axis."""
    x = np.array([x], dtype=float)
    stated = np.broadcast_to(np.array(stated, dtype=float), x.shape)
    zero = np.zeros_like(x)
    return motion_of(Poses(x, zero, zero, stated, np.array([steers])), 1.0, step_s, known)


def braking(count=30, step_s=0.1):
    """Places and speeds, from 20 m/s with 5 m/s²."""
    t = np.arange(count) * step_s
    return 20 * t - 2.5 * t * t, 20 - 5 * t


def test_stated_speeds_that_agree_with_places_are_taken():
    x, v = braking()
    found = motion(x, v)
    assert found.speed[0] == pytest.approx(v)
    assert found.vx[0] == pytest.approx(v)
    assert (found.speed_error == 0.005).all()
    # From places alone the first speed would be that of a quarter of a second later
    assert motion(x, v, known=OTHERS).speed[0, 0] == pytest.approx(20 - 1.25)


def test_stated_speeds_of_a_front_that_turns_are_taken():
    """Its middle makes less way in the bend than the front: where it goes straight they agree."""
    x = np.array([[0.0, 1.0, 2.0, 3.0, 3.6, 3.9, 3.9, 3.3, 2.3, 1.3, 0.3, -0.7]])
    y = np.array([[0.0, 0.0, 0.0, 0.0, 0.2, 0.7, 1.3, 1.8, 2.0, 2.0, 2.0, 2.0]])
    heading = np.radians([[0.0, 0, 0, 0, 40, 80, 120, 160, 180, 180, 180, 180]])
    stated = np.full(x.shape, 10.0)
    found = motion_of(Poses(x, y, heading, stated, np.array([True])), 0.2, 0.1, EXACT)
    assert found.speed[0].tolist() == pytest.approx([10.0] * 12)


def test_single_stated_speeds_that_cannot_be_are_known_no_better_than_places():
    """At 10 m/s for 8 s; for 0.3 s stated at 19 m/s, which tyres would not gain."""
    stated = np.full(81, 10.0)
    stated[40:43] = 19.0
    found = motion(np.arange(81.0), stated)
    assert found.speed_error[0, 40:43] == pytest.approx([9.0] * 3)
    assert np.delete(found.speed_error[0], [40, 41, 42]) == pytest.approx([EXACT.stated_mps] * 78)


def test_who_stops_at_once_stands():
    """Simulated cars may stop within a step: no more than the way to that state was driven."""
    stated = np.where(np.arange(81) < 40, 10.0, 0.0)
    found = motion(np.cumsum(stated) * 0.1, stated)
    assert found.speed_error[0] == pytest.approx([EXACT.stated_mps] * 81)


def test_who_backs_up_does_so_whatever_speed_is_stated():
    x, v = braking()
    found = motion(-x, v)
    assert found.vx[0] == pytest.approx(-v)
    assert found.speed[0] == pytest.approx(v)


def test_stated_speeds_that_make_another_way_are_not():
    x, v = braking()
    assert motion(x, v * 1.1).speed[0, 15] == pytest.approx(v[15])
    assert motion(x, 0.0).speed[0, 15] == pytest.approx(v[15])
    assert motion(x, 0.0).speed_error[0, 15] == pytest.approx(0.01)


def test_stated_means_since_the_step_before_are_taken():
    """As SUMO moves who brakes from 20 m/s within 5 s: in half a second by its new speed."""
    stated = np.arange(20.0, -1.0, -2.0)
    places = np.concatenate(([0.0], stated[1:].cumsum() * 0.5))
    found = motion(places, stated, step_s=0.5)
    assert found.speed[0] == pytest.approx(stated)
    assert found.speed_error[0] == pytest.approx([EXACT.stated_mps] * 11)


def test_a_speed_that_is_not_taken_as_stated_may_be_the_stated_one():
    """Braking by 4 m/s² on a lane that is drawn 1.3 times as long, in steps of 0.2 s."""
    stated = np.concatenate((np.full(20, 12.0), np.arange(12.0, 0.0, -0.8), np.full(20, 0.8)))
    found = motion((1.3 * stated).cumsum() * 0.2, stated, step_s=0.2)
    assert (found.speed[0] > stated * 1.1).any()
    assert (np.abs(found.speed[0] - stated) <= found.speed_error[0] + 1e-9).all()


def test_where_a_lane_is_drawn_longer_than_it_is_said_to_be_both_speeds_may_be_meant():
    """At 10 m/s, as stated, but for 3 s by its places at 14: the drawn lane is 1.4 times as long.

    The whole way is 9 % longer then, so nobody knows; of a way that is 3 % longer the stated
    speeds count, but distances on that lane are as little known.
    """
    for driven, error in ((13.0, 4.0), (40.0, EXACT.stated_mps)):
        drawn = np.full(round(driven * 10), 10.0)
        drawn[40:70] = 14.0
        found = motion(np.concatenate(([0.0], drawn.cumsum() * 0.1)), 10.0)
        assert found.speed_error[0, 55] == pytest.approx(error, abs=0.02)
        assert found.speed_error[0, 20] <= 0.02
        assert found.scale_error[0, [20, 55]] == pytest.approx([0.0, 4 / 14])


def test_who_does_not_steer_has_the_speed_of_its_places():
    x, v = braking()
    assert motion(x, v, steers=False).speed[0, 0] == pytest.approx(20 - 1.25)


def test_errors_grow_as_windows_shrink():
    x = 10 * np.arange(30) * 0.1
    error = motion(x, 0.0, known=OTHERS).speed_error[0]
    assert error[15] == pytest.approx(0.1)
    assert error[[0, -1]] == pytest.approx([0.2, 0.2])
    assert error[2] == pytest.approx(0.1 / 0.7)


def test_an_acceleration_is_the_difference_of_two_speeds():
    x = 10 * np.arange(40) * 0.1
    found = motion(x, 0.0, known=OTHERS)
    assert found.acceleration_error[0, 20] == pytest.approx(0.1 * np.sqrt(2))


def test_in_a_single_moment_there_is_what_is_stated():
    found = motion([np.nan, 3, np.nan], 7.0, known=OTHERS)
    assert found.speed[0, 1] == 7.0
    assert found.speed_error[0, 1] == 0.1


@pytest.mark.parametrize("slip", [0.0, 0.5, 1.5])
def test_a_track_that_slips_off_its_vehicle_tells_its_speed_no_better(slip):
    """At 10 m/s, and all at once farther: by 0.5 m that takes more than 5 m/s², by 1.5 m 16."""
    x = np.arange(60.0) + slip * (np.arange(60) >= 30)
    found = motion(x, 0.0, known=OTHERS)
    far = abs(np.arange(60) - 29.5) > 12
    assert found.speed_error[0, far].max() == pytest.approx(0.2)
    wrong = np.abs(found.speed[0] - 10.0)
    assert (wrong <= found.speed_error[0] + 0.01).all() == (slip != 0.5)
    assert (found.speed_error[0, 24:36] > 1.5).all() == (slip == 1.5)
    assert motion(x, 0.0, known=OTHERS, steers=False).speed_error[0, 30] == pytest.approx(0.1)


@pytest.mark.parametrize(("stretched", "seam"), [(3.0, True), (1.0, False)])
@pytest.mark.parametrize("way", [1, -1])
def test_a_track_that_is_stretched_at_a_seam_tells_its_speed_no_better(stretched, seam, way):
    """At 15 m/s, and within a second by 3 m farther, or less far: half of it within 0.5 s.

    That is 6 m/s faster in the middle, and 1.5 m and 6 m/s² over half a second, or a third of it.
    """
    t = np.arange(60) * 0.1
    hump = np.clip(t - 2.5, 0.0, 1.0)
    x = 15 * t + way * stretched * (3 * hump**2 - 2 * hump**3)
    found = motion(x, 0.0, known=OTHERS)
    wrong = np.abs(found.speed[0] - 15.0)
    assert wrong[30] == pytest.approx(stretched, abs=0.01)
    assert (wrong[10:50] <= 1.05 * found.speed_error[0, 10:50]).all() == seam
    far = abs(t - 3.0) > 2.0
    assert found.speed_error[0, far].max() == pytest.approx(0.2)


def test_who_brakes_as_hard_as_tyres_hold_has_not_slipped():
    t = np.arange(30) * 0.1
    error = motion(30 * t - 4.5 * t * t, 0.0, known=OTHERS).speed_error[0]
    assert error[10:20] == pytest.approx([0.1] * 10)


def test_a_file_that_contradicts_itself_tells_speeds_no_better():
    """Where stated speeds are not better than places: within a tenth both mean the same speed."""
    x, v = braking()
    plain, off = (motion(x, v * part, known=OTHERS) for part in (1.0, 1.05))
    mean = float(np.mean(plain.speed))
    assert off.speed == pytest.approx(plain.speed)
    own, then = plain.speed_error, 0.05 * plain.speed
    error = np.maximum(own + 0.05 * mean, np.hypot(own, then))
    assert off.speed_error == pytest.approx(error, rel=0.05)
    # What differs by more means something else, or nothing
    assert motion(x, v * 0.0, known=OTHERS).speed_error == pytest.approx(
        motion(x, v * 1.5, known=OTHERS).speed_error
    )


def test_a_track_that_contradicts_itself_for_a_while_tells_its_speed_no_better_then():
    """At 10 m/s, as stated, but by its places at 10.5 for 3 s, and as much slower later."""
    speed = np.full(120, 10.0)
    speed[20:50], speed[80:110] = 10.5, 9.5
    x = np.append(0.0, np.cumsum((speed[1:] + speed[:-1]) / 2 * 0.1))
    found = motion(x, 10.0, known=OTHERS)
    assert found.speed[0, [35, 95]] == pytest.approx([10.5, 9.5])
    assert found.speed_error[0, [35, 65, 95]] == pytest.approx([0.51, 0.1, 0.51], abs=0.01)


def test_at_a_track_s_ends_means_lie_nearer_to_each_other():
    """The first speed is of a quarter of a second later, and that half a second on of then."""
    x, v = braking()
    found = motion(x, 0.0, known=OTHERS)
    assert found.acceleration[0] == pytest.approx(np.full(30, -5.0))
    # So what braking changes in the time beside an end is not taken for half of it
    off = np.abs(found.speed[0] - v)
    assert off[[0, -1]] == pytest.approx([1.25, 1.25])
    assert (off <= found.speed_error[0]).all()
    # Of two places alone there is one speed, and no gain is known
    short = motion(x[:2], 0.0, known=OTHERS)
    assert short.acceleration[0] == pytest.approx([0.0, 0.0])
    assert short.acceleration_error[0] == pytest.approx([np.sqrt(2) / 0.1] * 2)


@pytest.mark.parametrize("step_s", [0.04, 1 / 30, 0.1, 0.12, 0.2, 0.3, 0.4, 0.5])
def test_speeds_are_means_over_a_second_whatever_the_step(step_s):
    """Who goes from 10 to 20 m/s at once shows by its mean speeds over how long they are means."""
    around = round(4 / step_s)
    t = np.arange(-around, around + 1) * step_s
    x = np.where(t < 0, 10 * t, 20 * t)
    found = motion(x, 0.0, known=OTHERS, steers=False, step_s=step_s)
    inside = slice(round(1 / step_s) + 1, -round(1 / step_s) - 1)
    means = 10 + 10 * np.clip(t + 0.5, 0, 1)
    assert found.speed[0, inside] == pytest.approx(means[inside])
    # A place between two is known no better than they are
    assert found.speed_error[0, inside] == pytest.approx(0.1)
    assert found.speed[0, [0, -1]] == pytest.approx([10, 20])


def test_steps_longer_than_half_a_second_are_taken_to_the_next_places():
    found = motion([0, 10, 20, 40, 60], 0.0, known=OTHERS, step_s=1.0)
    assert found.speed[0] == pytest.approx([10, 10, 15, 20, 20])
