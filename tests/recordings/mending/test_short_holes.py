"""States that are missing for a moment are where the ones around them say."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.recordings.mending.short_holes import without_short_holes
from rulec.recordings.recording import Participant, Recording, TrackState
from rulec.recordings.track import Track, TrackOutlines, TrackStates, rectangles

STEP_S = 0.1


def recording(*bodies):
    return Recording("", STEP_S, {}, bodies, ())


def braking(steps):
    """A car that brakes by 4 m/s² from 20 m/s, along x; as dicts."""
    states, outlines = {}, {}
    for step in steps:
        t = step * STEP_S
        state = TrackState(20 * t - 2 * t**2, 5.0, 0.0, 20 - 4 * t, -4.0)
        states[step] = state
        outlines[step] = rectangles(np.array([[state.x, state.y]]), np.zeros(1), 4.0, 2.0)[0]
    return Participant("1", "car", False, states, outlines)


def as_track(body):
    """The same, as a track of arrays."""
    steps = np.array(sorted(body.states), dtype=np.int64)
    rows = [body.states[step] for step in steps.tolist()]
    rows = np.array([(x.x, x.y, x.heading, x.speed, x.acceleration) for x in rows])
    track = Track(steps, rows, 4.0, 2.0)
    return replace(body, states=TrackStates(track), outlines=TrackOutlines(track))


@pytest.mark.parametrize("form", [lambda body: body, as_track])
@pytest.mark.parametrize("missing", [{10}, {1}, {18}, {4, 5, 6}, {7, 9, 11, 12}])
def test_what_is_missing_is_where_it_was(form, missing):
    whole, told = braking(range(20)), braking(set(range(20)) - missing)
    (filled,) = without_short_holes(recording(form(told)), 1.0).participants
    assert list(filled.states) == list(filled.outlines) == list(range(20))
    for step in range(20):
        assert filled.states[step].x == pytest.approx(whole.states[step].x, abs=1e-9)
        assert filled.states[step].speed == pytest.approx(whole.states[step].speed, abs=1e-9)
        assert np.allclose(filled.outlines[step], whole.outlines[step])


def test_a_long_hole_stays():
    told = recording(braking([*range(5), *range(20, 30)]))
    assert without_short_holes(told, 1.0).participants is told.participants


def test_who_jumps_was_nowhere_between():
    one, other = braking(range(10)), braking(range(20))
    states = one.states | {step: replace(other.states[step], x=500.0 + step) for step in (13, 14)}
    outlines = one.outlines | {step: other.outlines[step] for step in (13, 14)}
    told = recording(replace(one, states=states, outlines=outlines))
    assert without_short_holes(told, 1.0).participants[0].states.keys() == states.keys()


def test_headings_turn_the_short_way():
    body = braking([0, 1, 3, 4])
    way = {0: 3.0, 1: 3.1, 3: -3.1, 4: -3.0}
    states = {step: replace(body.states[step], heading=way[step]) for step in body.states}
    (filled,) = without_short_holes(recording(replace(body, states=states)), 1.0).participants
    assert abs(filled.states[2].heading) == pytest.approx(np.pi)


def test_lamps_are_lit_that_are_lit_on_both_sides():
    lamps = {0: frozenset({"brake_light"}), 2: frozenset({"brake_light"}), 4: frozenset()}
    body = replace(braking([0, 2, 4]), lamps=lamps)
    (filled,) = without_short_holes(recording(body), 1.0).participants
    assert filled.lamps == lamps | {1: frozenset({"brake_light"})}


def of_kind(steps, kind="car", name="1"):
    return replace(braking(steps), type=kind, id=name)


def test_who_is_missing_for_longer_is_named():
    """What it does meanwhile, such as a whole change of lanes, is in no drive."""
    some = [k for k in range(40) if not 10 <= k < 25]
    bodies = [of_kind(some, name=name) for name in "1234"]
    (remark,) = without_short_holes(recording(*bodies, of_kind(range(40), name="5")), 1.0).remarks
    assert remark == (
        "4 vehicles are missing for more than 1 s on the way, and what happens meanwhile is not "
        "judged: `1`, `2`, `3`, and 1 more"
    )


@pytest.mark.parametrize("kind", ["pedestrian", "unknown"])
def test_who_has_no_drive_may_be_missing(kind):
    some = [k for k in range(40) if not 10 <= k < 25]
    assert without_short_holes(recording(of_kind(some, kind)), 1.0).remarks == ()


def test_who_is_missing_for_a_moment_needs_no_remark():
    some = [k for k in range(40) if not 10 <= k < 15]
    assert without_short_holes(recording(of_kind(some)), 1.0).remarks == ()
