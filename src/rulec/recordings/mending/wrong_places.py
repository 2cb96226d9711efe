"""Wrong places: a body would have had to go there, and back, faster than any can.

They are left out, and filled in like other holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import bool_, float64, int64
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.mending.cut_tracks import first_ids
from rulec.recordings.mending.rows_of_states import rows_of, steps_of, with_mended, with_states_at
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.track import outlines_on_track

FARTHER_M = 1.0
"""A place is wrong by at least so much."""

_NOISES, _NOISE_PART = 3.0, 0.75
"""Besides, by three times as much as three in four of the track's places are off."""

LEAST_MPS2 = 20.0
"""Twice what tyres can: bodies do not accelerate like that."""

_MOST_WRONG, _WRONG_S = 3, 0.3
"""So many places in a row, in so long a time (s), may be wrong; one always may."""

_SMOOTH = 0.5
"""The way past wrong places goes on as before and afterwards to within this part of their error:
otherwise the track slipped, or jumped for good."""

_HAIR = 1e-9


@dataclass(frozen=True, eq=False, slots=True)
class Path:
    """The places (m) of a body by ascending time step."""

    steps: NDArray[int64]
    places: Floats


def without_wrong_places(recording: Recording) -> Recording:
    """A recording without wrong places, and a remark if there are any."""
    wrong: dict[str, int] = {}

    def right(body: Participant) -> Participant:
        path = path_of(body)
        found = wrong_places(path, recording.step_s)
        if not found.any():
            return body
        wrong[body.id] = int(found.sum())
        return with_states_at(body, path.steps[~found])

    mended = with_mended(recording, right)
    if not wrong:
        return recording
    remark = wrong_places_remark([*wrong], sum(wrong.values()))
    return replace(mended, remarks=(*recording.remarks, remark))


def path_of(body: Participant) -> Path:
    """The path of a participant; empty if it stands, or has places that are no track."""
    on_track = outlines_on_track(body) is not None
    if body.standing or not (on_track or body.states.keys() == body.outlines.keys()):
        return Path(np.zeros(0, dtype=int64), np.zeros((0, 2)))
    return Path(steps_of(body), rows_of(body)[:, :2])


def wrong_places_remark(names: Sequence[str], count: int) -> str:
    """A remark on the number of wrong places, and the ids of the tracks that have some."""
    what = "1 position is" if count == 1 else f"{count:,} positions are"
    return f"{what} left out, as no vehicle gets there so fast: {first_ids(names)}"


def wrong_places(path: Path, step_s: float) -> NDArray[bool_]:
    """Mask of places to which the body would have to go, and back, faster than any can.

    Up to ``_MOST_WRONG`` in a row. At a track's ends nothing shows where it was.
    """
    steps, places = path.steps, path.places
    found = np.zeros(len(steps), dtype=bool)
    if len(steps) < 4 or is_smooth(path):
        return found
    times: Floats = (steps * step_s).astype(float64)
    least = farthest_by_noise(_off_chord(times, places, 1)[0])
    for count in range(1, most_in_a_row(step_s) + 1):
        off = _off_chord(times, places, count).min(axis=0)
        leaves = times[1 : len(off) + 1] - times[: len(off)]
        returns = times[count + 1 :] - times[count:-1]
        is_wrong = off > np.maximum(least, LEAST_MPS2 / 2 * np.maximum(leaves, returns) ** 2)
        is_wrong &= times[count + 1 :] - times[: len(off)] <= 2 * (count + 1) * step_s + _HAIR
        for first in is_wrong.nonzero()[0].tolist():
            if _goes_on(times, places, first, first + count + 1) <= _SMOOTH * off[first]:
                found[first + 1 : first + count + 1] = True
    return found


def most_in_a_row(step_s: float) -> int:
    """How many places in a row may be wrong."""
    return max(1, min(_MOST_WRONG, int(_WRONG_S / step_s + _HAIR)))


def is_smooth(path: Path) -> bool:
    """Whether each place of a path is nearly where the two before it lead to; most paths are."""
    if len(path.steps) < 3:
        return True
    return bool(bends_of(path.steps, *path.places.T).max() <= FARTHER_M**2)


def bends_of(steps: NDArray[int64], x: Floats, y: Floats) -> Floats:
    """How far each place but two is from where those before it lead to, squared (m²)."""
    between = steps[1:] - steps[:-1]
    # Rows of several tracks may follow each other
    even = bool((between == 1).all())
    between = np.maximum(between, 1)
    squares: Floats = np.zeros(max(len(steps) - 2, 0))
    for place in (x, y):
        ways = place[1:] - place[:-1]
        if even:
            bends = ways[1:] - ways[:-1]
        else:
            ways /= between
            bends = (ways[1:] - ways[:-1]) * np.minimum(between[1:], between[:-1])
        squares += bends * bends
    return squares


def _off_chord(times: Floats, places: Floats, count: int) -> Floats:
    """How far (m) ``count`` places in a row are from the line between those before and after.

    A row for each of them, a column for each place before.
    """
    before, behind = slice(None, -count - 1), slice(count + 1, None)
    way = (places[behind] - places[before]) / (times[behind] - times[before])[:, None]
    n = len(way)
    return np.array(
        [
            np.hypot(
                *(
                    places[k : n + k]
                    - places[before]
                    - way * (times[k : n + k] - times[before])[:, None]
                ).T
            )
            for k in range(1, count + 1)
        ]
    )


def farthest_by_noise(off: Floats) -> float:
    """How far (m) a place of a track is off by noise at most, by how far all of them are."""
    rank = min(int(_NOISE_PART * len(off)), len(off) - 1)
    return FARTHER_M + _NOISES * float(np.partition(off, rank)[rank])


def _goes_on(times: Floats, places: Floats, before: int, behind: int) -> float:
    """How far (m) the line through two places misses the place before them and the one after."""
    way = (places[behind] - places[before]) / (times[behind] - times[before])
    beyond = [k for k in (before - 1, behind + 1) if 0 <= k < len(places)]
    missed = (places[before] + way * (times[k] - times[before]) - places[k] for k in beyond)
    return max((float(np.hypot(*off)) for off in missed), default=np.inf)
