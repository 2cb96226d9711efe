"""Of a long recording only a part is looked at at a time, which changes nothing."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given

from rulec import read_recording
from rulec.extraction import drives
from rulec.extraction.drives import Drives
from rulec.extraction.traffic_thresholds import USUAL
from support.generators.random_recordings import scenes
from support.worlds.stored import StoredWorld


def told(found, thresholds=USUAL):
    egos = Drives(found, "right").egos()
    drives = Drives(found, "right", thresholds, expected=egos)
    return [one for ego in egos for one in drives.of(ego)]


@given(scenes())
def test_a_part_at_a_time(found):
    usual = told(found)
    # One by one, as who is not expected
    alone = Drives(found, "right")
    assert [one for ego in alone.egos() for one in alone.of(ego)] == usual
    for most_of_all in (drives.MOST_OF_ALL, 2.0):
        with (
            patch.object(drives, "MOST_PLACES", 0),
            patch.object(drives, "MOST_OF_ALL", most_of_all),
        ):
            assert told(found) == usual


@pytest.mark.parametrize("world", ["priority", "motorway", "roundabout"])
def test_who_is_out_of_reach_changes_nothing(world, monkeypatch):
    # So near that even in a small world some are farther away
    near = replace(USUAL, near_m=20.0, catching_up_s=1.0)
    stored = StoredWorld(world)
    found = read_recording(stored.data, stored.net)
    monkeypatch.setattr(drives, "MOST_PLACES", 0)
    rows_in_reach, left_out = drives.rows_in_reach, []

    def noted(tracks, road, egos, limits):
        flags = rows_in_reach(tracks, road, egos, limits)
        present = [tracks.present[:, columns].any(axis=1) for _, columns in egos]
        left_out.append(np.logical_or.reduce(present) & ~flags)
        return flags

    monkeypatch.setattr(drives, "rows_in_reach", noted)
    some, alone = told(found, near), Drives(found, "right", near)
    one_by_one = [one for ego in alone.egos() for one in alone.of(ego)]
    everybody = np.ones_like(left_out[0])
    monkeypatch.setattr(drives, "rows_in_reach", lambda *_: everybody)
    assert told(found, near) == some == one_by_one
    assert 2 * sum(map(np.count_nonzero, left_out)) >= len(left_out) > 10


@pytest.mark.parametrize("world", ["priority", "grid", "roundabout"])
def test_who_is_far_from_the_road_changes_nothing(world, monkeypatch):
    stored = StoredWorld(world)
    found = read_recording(stored.data, stored.net)
    monkeypatch.setattr(drives, "MOST_PLACES", 0)
    monkeypatch.setattr(drives, "MOST_OF_ALL", 2.0)
    near_road, left_out = drives.near_road, []

    def noted(tracks, road, at, thresholds, step_s):
        flags = near_road(tracks, road, at, thresholds, step_s)
        left_out.append(np.count_nonzero(tracks.present[at] & ~flags))
        return flags

    monkeypatch.setattr(drives, "near_road", noted)
    some = told(found)
    monkeypatch.setattr(drives, "near_road", lambda tracks, _, at, *__: tracks.present[at])
    assert told(found) == some
    assert sum(left_out) > 100


def test_places_are_dropped_after_the_last_drive_that_awaits_them(monkeypatch):
    stored = StoredWorld("priority")
    found = read_recording(stored.data, stored.net)
    monkeypatch.setattr(drives, "MOST_PLACES", 0)
    monkeypatch.setattr(drives, "MOST_CELLS", 1)
    egos = Drives(found, "right").egos()
    looked = Drives(found, "right", expected=egos)
    kept = [len(looked._parts) for ego in egos for _ in looked.of(ego)]
    assert max(kept) > 0
    assert kept[-1] == 0
