"""Recordings with all repairs of tracks, applied once."""

from __future__ import annotations

from dataclasses import replace

from rulec.recordings.mending.fast_unknowns import with_fast_unknowns
from rulec.recordings.mending.short_holes import LONGEST_HOLE_S, without_short_holes
from rulec.recordings.mending.steady_headings import with_steady_headings
from rulec.recordings.mending.track_jumps import without_jumps
from rulec.recordings.mending.wrong_places import without_wrong_places
from rulec.recordings.recording import MENDED, Recording


def mended(recording: Recording, longest_hole_s: float = LONGEST_HOLE_S) -> Recording:
    """A recording without wrong places and jumps, and without holes up to this length.

    Headings are steady. Participants of unknown type are vehicles if they drive as only vehicles
    can. It is marked as ``MENDED``, and is not repaired again.
    """
    if MENDED in recording.complete:
        return recording
    placed = without_jumps(without_wrong_places(recording))
    steady = with_steady_headings(with_fast_unknowns(placed))
    repaired = without_short_holes(steady, longest_hole_s)
    return replace(repaired, complete=repaired.complete | {MENDED})
