"""Presences: the contiguous parts of a trace in which a participant is an object."""

import itertools
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.presences import presence_names, presence_runs
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording, straight

STEPS = 12
ROAD = [straight(1, -100, 300)]


def found(flags, away_s=1.0, nowhere=(), others=("8",), far_away=()):
    """Name, first and last column of each presence; half a second lies between two columns.

    Those ``far_away`` are in the recording, but not in the drive.
    """
    bodies = [steady(name, 30 + 10 * k, 0, steps=STEPS) for k, name in enumerate(others)]
    cars = [steady(7, 0, 0, steps=STEPS), *bodies]
    cars += [steady(name, 9_000, 9_000, steps=STEPS) for name in far_away]
    context = context_of(recording(ROAD, cars), away_s=away_s)
    s_min = context.extents.s_min.copy()
    s_min[0, list(nowhere)] = np.nan
    rows = np.zeros_like(context.relevant)
    rows[0] = flags
    rows[1:] = True
    everybody = np.arange(len(s_min))
    extents = replace(context.extents.part(everybody, slice(STEPS)), s_min=s_min)
    context = replace(context, relevant=rows, extents=extents)
    runs = presence_runs(context)
    return list(zip(presence_names(context), runs.first, runs.last, strict=True))


def flags(text):
    return [sign == "#" for sign in text]


def test_short_absences_are_bridged():
    # A second is two columns
    assert found(flags("##..###.####")) == [("8", 0, 11)]
    assert found(flags("##...##.####")) == [("8", 0, 1), ("8_2", 5, 11)]
    assert found(flags("##.#########"), away_s=0.0) == [("8", 0, 1), ("8_2", 3, 11)]
    assert found(flags("...###......")) == [("8", 3, 5)]


def test_an_absence_off_the_road_is_never_bridged():
    assert found(flags("##.#########"), nowhere=[2]) == [("8", 0, 1), ("8_2", 3, 11)]


def test_names_that_others_have_are_left_out():
    parts = found(flags("##....##....")) + found(flags("##....##...."), others=("8", "8_2"))
    assert parts == [("8", 0, 1), ("8_2", 6, 7), ("8", 0, 1), ("8_3", 6, 7), ("8_2", 0, 11)]


def test_names_of_participants_elsewhere_are_left_out():
    parts = found(flags("##....##...."), far_away=("8_2",))
    assert parts == [("8", 0, 1), ("8_3", 6, 7)]


@given(st.lists(st.booleans(), min_size=STEPS, max_size=STEPS).filter(any), st.integers(0, 4))
def test_presences_are_what_is_relevant_and_short_gaps(relevant, columns):
    parts = found(relevant, away_s=columns * 0.5)
    covered = [k for _, first, last in parts for k in range(first, last + 1)]
    assert covered == sorted(set(covered))
    assert {k for k in range(STEPS) if relevant[k]} <= set(covered)
    for _, first, last in parts:
        assert relevant[first]
        assert relevant[last]
    # Gaps inside are short, gaps between are long
    for (_, _, before), (_, after, _) in itertools.pairwise(parts):
        assert after - before - 1 > columns
    missing = "".join("." if k in covered and not relevant[k] else "#" for k in range(STEPS))
    assert max(map(len, missing.split("#"))) <= columns
