"""A mirrored recording gives mirrored words."""

from dataclasses import asdict, fields, replace

import numpy as np
from hypothesis import given

from rulec.extraction.drives import Drive, Drives
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.vocabulary.partial_values import Interval
from support.builders.recordings import recording, straight
from support.generators.random_recordings import scenes
from support.measured import middle

_MIRRORED = {
    "left_of": "right_of",
    "right_of": "left_of",
    "l": "r",
    "r": "l",
}
_OTHER = {"left": "right", "right": "left"}


def drives(found, side):
    told = Drives(found, side)
    return [one for ego in told.egos() for one in told.of(ego)]


def in_a_mirror(value):
    if isinstance(value, dict):
        return {name: in_a_mirror(inner) for name, inner in value.items()}
    return _MIRRORED.get(value, value) if isinstance(value, str) else value


def assert_alike(one, other):
    """States are the same up to the last digit of numbers."""
    assert one.keys() == other.keys()
    for name, value in one.items():
        if isinstance(value, dict):
            assert_alike(value, other[name])
        elif isinstance(value, Interval) and isinstance(other[name], Interval):
            assert_alike({"low": value.low, "high": value.high}, asdict(other[name]))
        elif isinstance(value, float | Interval):
            value, seen = middle([value, other[name]])
            assert abs(value - seen) <= 0.011, name
        else:
            assert value == other[name], name


@given(scenes())
def test_words_of_the_mirror_are_the_mirrors_words(found):
    for one, other in zip(
        drives(found, "right"), drives(mirrored_recording(found), "left"), strict=True
    ):
        assert isinstance(one, Drive) == isinstance(other, Drive)
        if isinstance(one, Drive):
            assert one.trace.objects == other.trace.objects
            assert one.trace.present == other.trace.present
            for state, seen in zip(one.trace.states, other.trace.states, strict=True):
                assert_alike(in_a_mirror(state), seen)


@given(scenes())
def test_a_mirror_in_a_mirror_shows_what_there_is(found):
    found = replace(found, side="right")
    twice = mirrored_recording(mirrored_recording(found))
    assert twice.side == found.side
    assert twice.lanelets.keys() == found.lanelets.keys()
    for key, lanelet in found.lanelets.items():
        for field in fields(lanelet):
            ours, theirs = getattr(lanelet, field.name), getattr(twice.lanelets[key], field.name)
            assert np.array_equal(ours, theirs) if field.name in LINES else ours == theirs
    for one, other in zip(found.participants, twice.participants, strict=True):
        assert one.states == other.states
        assert one.lamps == other.lamps
        for step, outline in one.outlines.items():
            assert np.array_equal(outline, other.outlines[step])


LINES = ("left", "right", "centre")


def test_every_line_of_a_lanelet_is_mirrored():
    drawn = straight(1, 0, 10, 3, stop_line=np.array([(10.0, 1.0), (10.0, 5.0)]))
    (seen,) = mirrored_recording(recording([drawn], [])).lanelets.values()
    lines = {x.name for x in fields(drawn) if isinstance(getattr(drawn, x.name), np.ndarray)}
    assert lines == {*LINES, "stop_line"}
    for name in lines:
        places = {tuple(place) for place in getattr(seen, name).tolist()}
        other = {"left": "right", "right": "left"}.get(name, name)
        assert places == {(x, -y) for x, y in getattr(drawn, other).tolist()}
