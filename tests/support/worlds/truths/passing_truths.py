"""Passing on the near side of a motorway: who got past whom on which lanes."""

import numpy as np

from support.worlds.facts import Fact, runs
from support.worlds.world_state import LENGTH_M

_QUEUE_M, _QUEUE = 110.0, 3
_SLOW_MPS = 17.0
"""A queue beside which one may pass goes at 60 km/h at most, 16.7 m/s."""

_NEARER_M, _BESIDE_M, _ALIKE = 0.9, 10.0, 0.7
_ABOUT_M = 0.5
"""Where two are so nearly level nobody can say whether they are."""

_SEEN_S = 0.5
"""Who is seen behind for less has hardly come from there: recordings have every second state."""


LETS_PASS_ON_LANES = ("us", "au")
"""How names of books begin whose statutes let one pass on the near side in a lane of its own: UVC
11-304(a)(2) where there is room for two lines that go one way, California's 21754(b) and (c), the
states' copies of the former, and rule 141(1)(a) of Australia and of New South Wales."""


def near_side_facts(world):
    """Who came from behind, was beside on a lane nearer to the kerb, and got in front.

    Where lanes are marked, as the simulator's are, some statutes let everybody do so.
    """
    if world.book.startswith(LETS_PASS_ON_LANES):
        return
    for track in world.vehicles.values():
        for other in world.vehicles.values():
            if other is not track:
                yield from _passes(world, track, other)


def _passes(world, track, other):
    first = max(track.step[0], other.step[0])
    last = min(track.step[-1], other.step[-1])
    if last <= first:
        return
    own = slice(first - track.step[0], last - track.step[0] + 1)
    theirs = slice(first - other.step[0], last - other.step[0] + 1)
    ahead = track.column("pos")[own] - other.column("pos")[theirs]
    same = np.array(
        [
            world.net.lanes[a].edge == world.net.lanes[b].edge
            for a, b in zip(track.lane[own], other.lane[theirs], strict=True)
        ]
    )
    nearer = _index(world, track, own) < _index(world, other, theirs)
    yield from _past_junctions(world, (track, own), (other, theirs), same)
    level = runs((np.abs(ahead) <= LENGTH_M) & same)
    about = runs((np.abs(ahead) <= LENGTH_M + _ABOUT_M) & same)
    for begin, end in sorted({*level, *about}):
        if begin == 0 or ahead[begin] > 0 or ahead[end] < 0:
            continue
        # Who is level to the end has not got past, unless it is in front but for a hair
        to_the_end = end == len(ahead) - 1
        if to_the_end and ahead[end] < LENGTH_M - _ABOUT_M:
            continue
        # Who changes lanes beside the other may be there for some of the time only
        around = slice(max(0, begin - 1), end + 2)
        moves = any(
            world.changing[one.id][rows][around].any()
            for one, rows in ((track, own), (other, theirs))
        )
        if not nearer[around].any() and not moves:
            continue
        sure = nearer[around].all() and not moves and not to_the_end
        sure &= begin * world.step_s >= _SEEN_S and not _on_ramp(world, track, own, around)
        sure &= (begin, end) in level and not _in_queues(world, track, other, first + begin)
        at = ((first + begin - 10) * world.step_s, (first + end + 10) * world.step_s)
        yield Fact(track.id, "near_side_passing", *at, bool(sure), other.id)


def _on_ramp(world, track, own, around):
    """True if one is on a lane to join from, on which one may be faster: it leads no farther."""
    starts = {link.start for link in world.net.links.values()}
    goes_on = {world.net.lanes[lane].edge for lane in starts}
    lanes = set(track.lane[own][around])
    return any(lane not in starts and world.net.lanes[lane].edge in goes_on for lane in lanes)


def _past_junctions(world, one, another, same):
    """Unsure: who may get past where roads begin or end, by places in the plane."""
    (track, own), (other, theirs) = one, another
    x, y, turned = (
        track.column(name)[own] - other.column(name)[theirs] for name in ("x", "y", "angle")
    )
    angle = np.radians(other.column("angle")[theirs])
    ahead, aside = x * np.sin(angle) + y * np.cos(angle), x * np.cos(angle) - y * np.sin(angle)
    beside = (np.abs(aside) < _BESIDE_M) & (np.cos(np.radians(turned)) > _ALIKE)
    for begin, end in runs(beside & (np.abs(ahead) <= LENGTH_M + _ABOUT_M)):
        nearer = (aside[begin : end + 1] * (-1 if world.net.lefthand else 1) > _NEARER_M).any()
        if nearer and ahead[begin] < 0 < ahead[end] and not same[begin : end + 1].all():
            first = track.step[own.start]
            at = ((first + begin - 10) * world.step_s, (first + end + 10) * world.step_s)
            yield Fact(track.id, "near_side_passing", *at, False, other.id)


def _index(world, track, rows):
    return np.array([world.net.lanes[lane].index for lane in track.lane[rows]])


def _in_queues(world, track, other, step):
    """True if queues might excuse it: traffic is dense, or slow."""
    lanes = {}
    place = track.column("pos")[track.at(step)]
    for one in world.vehicles.values():
        row = one.at(step)
        if row is not None and abs(one.column("pos")[row] - place) < _QUEUE_M:
            lanes.setdefault(one.lane[row], []).append(one.id)
    slow = other.column("speed")[other.at(step)] < _SLOW_MPS
    dense = lanes and min(map(len, lanes.values())) >= _QUEUE
    return bool(slow or dense)
