"""How many calls a drive through a town takes: loops over states or all others are seen here."""

import sys

import pytest

from rulec import read_recording
from rulec.extraction.drives import Drives
from support.worlds.stored import StoredWorld

MOST = {"grid": 23_500, "priority": 19_500}
"""Calls of functions for a drive with all of its words, by world; an eighth more than they take."""


@pytest.mark.parametrize("name", list(MOST))
def test_calls_for_a_drive(name):
    world = StoredWorld(name)
    found = read_recording(world.data, world.net)

    def made():
        drives = Drives(found, "right")
        expecting = Drives(found, "right", expected=drives.egos())
        return [drive for ego in drives.egos() for drive in expecting.of(ego)]

    # What the first call in a process loads is not counted
    n_drives, calls = len(made()), 0

    def counted(_frame, event, _argument):
        nonlocal calls
        calls += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(counted)
    try:
        made()
    finally:
        sys.setprofile(before)
    assert calls / n_drives < MOST[name]
