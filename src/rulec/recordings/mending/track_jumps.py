"""Jumps of tracks to another body: it cannot have driven there, and does not come back.

Where the ids of two bodies are exchanged, each track goes on with the other one's body.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count, pairwise

import numpy as np

from rulec.array_types import Floats
from rulec.recordings.mending.cut_tracks import cut_remark
from rulec.recordings.mending.rows_of_states import with_states_at
from rulec.recordings.mending.wrong_places import (
    LEAST_MPS2,
    Path,
    farthest_by_noise,
    is_smooth,
    most_in_a_row,
    path_of,
    wrong_places_remark,
)
from rulec.recordings.recording import Participant, Recording

_HELD_MPS = 0.5
"""A track that moves less before or after a jump may have been held, and catches up by it."""

_ACROSS = 0.7
"""A jump that is along the way by less than this part of what it is across is a simulator's change
of lanes."""

_NEAR = 0.5
"""Bodies have exchanged places if each is where the other was expected, to within this part of
their distance."""

DRIVERS = frozenset({"vehicle", "light_rider"})
"""Who is looked at: simulated pedestrians jump from the pavement onto crossings."""

CUT_WHY = "jumps that no vehicle can make"

_HAIR = 1e-9


def without_jumps(recording: Recording) -> Recording:
    """A recording whose tracks are cut at jumps, with remarks; what follows is somebody else."""
    bodies = [body for body in recording.participants if DRIVERS.intersection(body.object_types)]
    paths = [path_of(body) for body in bodies]
    cuts = {
        body.id: (path, own)
        for body, path, own in zip(bodies, paths, jumps(paths, recording.step_s), strict=True)
        if own
    }
    if not cuts:
        return recording
    ids, remarks = set(recording.ids), list(recording.remarks)
    participants: list[Participant] = []
    cut: list[str] = []
    wrong: dict[str, int] = {}
    for body in recording.participants:
        if body.id not in cuts:
            participants.append(body)
            continue
        path, own = cuts[body.id]
        parts = parts_between(own, len(path.steps), recording.step_s)
        if left_out := len(path.steps) - sum(end - start for start, end in parts):
            wrong[body.id] = left_out
        if len(parts) > 1:
            cut.append(body.id)
        for number, (start, end) in enumerate(parts, 1):
            part = with_states_at(body, path.steps[start:end])
            if number > 1:
                name = next(x for k in count(number) if (x := f"{body.id}_{k}") not in ids)
                ids.add(name)
                part = replace(part, id=name, resumes=int(path.steps[parts[number - 2][1] - 1]))
            participants.append(part)
    if wrong:
        remarks.append(wrong_places_remark([*wrong], sum(wrong.values())))
    if cut:
        remarks.append(cut_remark(cut, CUT_WHY))
    return replace(recording, participants=tuple(participants), remarks=tuple(remarks))


def parts_between(cuts: Sequence[int], states: int, step_s: float) -> list[tuple[int, int]]:
    """The parts of so many ``states`` between cuts, without those so short that they are errors."""
    parts = [*pairwise([0, *cuts, states])]
    longest = max(parts, key=lambda part: part[1] - part[0])
    brief = most_in_a_row(step_s) if cuts else 0
    return [part for part in parts if part[1] - part[0] > brief or part == longest]


@dataclass(frozen=True, eq=False, slots=True)
class _Jump:
    """A jump of a track from where its body was expected (m) to its place, by index in its path.

    ``surely``: not as simulators move bodies sideways.
    """

    track: int
    index: int
    expected: Floats
    place: Floats
    surely: bool


def jumps(paths: Sequence[Path], step_s: float) -> list[list[int]]:
    """For each path the indices of the places to which its body cannot have driven.

    Neither do bodies exchange their places within a step, however close they are.
    """
    found: list[list[int]] = [[] for _ in paths]
    at_step: dict[int, list[_Jump]] = defaultdict(list)
    for track, path in enumerate(paths):
        for jump in _jumps_of(track, path, step_s):
            at_step[int(path.steps[jump.index])].append(jump)
    for together in at_step.values():
        for one in together:
            if one.surely or any(_exchanged(one, other) for other in together):
                found[one.track].append(one.index)
    return [sorted(own) for own in found]


def _jumps_of(track: int, path: Path, step_s: float) -> list[_Jump]:
    """The jumps from one step to the next: ways unlike that before and that after."""
    if is_smooth(path):
        return []
    steps = np.diff(path.steps)
    ways = np.diff(path.places, axis=0) / steps[:, None]
    # At a track's ends there is only one
    beside = np.concatenate((ways[1:2], ways[:-1])), np.concatenate((ways[1:], ways[-2:-1]))
    sizes = np.array([np.hypot(*(ways - own).T) for own in beside])
    size = sizes.min(axis=0)
    least = max(farthest_by_noise(size), LEAST_MPS2 / 2 * step_s**2)
    found = []
    for at in ((steps == 1) & (size > least)).nonzero()[0].tolist():
        usual = beside[int(sizes[:, at].argmin())][at]
        own, length = ways[at] - usual, float(np.hypot(*usual))
        along = abs(float(own @ usual)) / max(length, _HAIR)
        across = float(np.sqrt(max(float(own @ own) - along**2, 0.0)))
        held = min(float(np.hypot(*way[at])) for way in beside) < _HELD_MPS * step_s
        surely = not held and along > max(least, _ACROSS * across)
        expected = path.places[at] + usual
        found.append(_Jump(track, at + 1, expected, path.places[at + 1], surely))
    return found


def _exchanged(one: _Jump, other: _Jump) -> bool:
    """Whether two bodies are where the other one was expected."""
    if one.track == other.track:
        return False
    apart = np.hypot(*(one.expected - other.expected))
    off = (one.place - other.expected, other.place - one.expected)
    return bool(max(np.hypot(*own) for own in off) < _NEAR * apart)
