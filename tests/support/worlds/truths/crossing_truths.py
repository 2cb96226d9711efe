"""Zebra crossings: who drove onto one while somebody was on it or had to wait beside it."""

import numpy as np

from support.worlds.facts import Fact
from support.worlds.truths.following_truths import BRAKING_MPS2, REACTION_S
from support.worlds.world_state import LENGTH_M, WIDTH_M

_SOON_S = 3.0
_WAITED_S = 3.0
_STANDS_MPS = 0.1
_CLEAR_M = 1.0

_WALKER_M = 0.215
"""From front to back: SUMO's own length of who walks."""


def pedestrian_facts(world):
    """Vehicles on a crossing; sure where a walker has yet to pass ego's lane, or has waited."""
    for crossing in world.crossings:
        walk = f":{crossing.link.junction}_c0"
        if walk not in world.net.edges:
            continue
        placed = world.along(crossing)
        length = sum(world.net.lanes[lane].length for lane in crossing.link.inner)
        # A corner of who is askew as it changes lanes reaches farther than the middle of its front
        askew = world.changing[crossing.track.id][crossing.row - 1]
        beside_m = WIDTH_M / 2 if askew else 0.0
        before_end = placed - LENGTH_M < length
        on_it = np.flatnonzero((placed > 0) & before_end)
        perhaps = np.flatnonzero((placed > -beside_m) & before_end)
        steps, reached = ([crossing.track.step[row] for row in rows] for rows in (on_it, perhaps))
        at = (reached[0] * world.step_s, reached[-1] * world.step_s)
        for walker in world.walkers.values():
            grade = _grade(world, walker, walk, (steps, crossing.link.inner[0]))
            if askew and grade is None:
                # How far the corner reaches nobody tells for sure
                by_corner = _grade(world, walker, walk, (reached, crossing.link.inner[0]))
                grade = None if by_corner is None else False
            # Nobody has to do what cannot be done any more
            grade = grade and _in_time(world, crossing, walker, walk)
            if grade is not None:
                yield Fact(crossing.track.id, "give_way_to_pedestrians", *at, grade, walker.id)


def _grade(world, walker, walk, where):
    """True for a violation, False where one cannot tell, None for none."""
    steps = where[0]
    found = _on_crossing(world, walker, walk, where)
    if found or _waited(world, walker, walk, steps[0]):
        # In Britain who waits is another rule's, and only advice
        return bool(found) or world.book != "gb"
    if found is False or _soon_on_it(world, walker, walk, steps):
        return False
    return None


def _in_time(world, crossing, walker, walk):
    """True if it was on the crossing, or stood beside it, when one could still stop for it."""
    speed = crossing.track.column("speed")[crossing.row]
    lead = REACTION_S + speed / (2 * BRAKING_MPS2)
    row = walker.at(crossing.track.step[crossing.row] - round(lead / world.step_s))
    if row is None:
        return False
    stands = walker.column("speed")[row] < _STANDS_MPS
    area = walk.rpartition("_")[0] + "_w"
    return walker.lane[row] == walk or bool(stands and walker.lane[row].startswith(area))


def _on_crossing(world, walker, walk, where):
    """True if it is on the crossing and has yet to pass ego's lane; False where that is close."""
    steps, key = where
    lane = world.net.lanes[key]
    beside = world.net.edges[lane.edge].lanes.values()
    grades = set()
    for step in steps:
        row = walker.at(step)
        if row is not None and _drawn_on_road(world, walker, row, walk):
            grades.add(False)
        if row is None or walker.lane[row] != walk:
            continue
        x, y = (walker.column(name)[row] for name in ("x", "y"))
        ahead = _across(walker, walk)
        left = [(one.shape.mean(axis=0) - (x, y)) @ ahead + one.width / 2 for one in beside]
        own = (lane.shape.mean(axis=0) - (x, y)) @ ahead + lane.width / 2
        grades.add(True if own > 0.3 else (False if max(left) > -_CLEAR_M else None))
    return True if True in grades else (False if False in grades else None)


def _drawn_on_road(world, walker, row, walk):
    """True if it is on the pavement, but drawn on a lane: SUMO rounds its corners in jumps.

    Whether it walks over the crossing afterwards the world's end may hide. What counts is its
    middle; the simulator tells where its front is.
    """
    if not walker.lane[row].startswith(walk.rpartition("_")[0] + "_w"):
        return False
    start, *_, end = world.net.lanes[f"{walk}_0"].shape
    x, y, angle = (walker.column(name)[row] for name in ("x", "y", "angle"))
    faces = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    middle = np.array([x, y]) - np.array(faces) * _WALKER_M / 2
    ahead = (end - start) / np.hypot(*(end - start))
    return 0 < (middle - start) @ ahead < np.hypot(*(end - start))


def _across(walker, walk):
    """The direction in which it crosses; on its last step there it may look elsewhere."""
    rows = [row for row, lane in enumerate(walker.lane) if lane == walk]
    x, y = (walker.column(name)[rows[-1]] - walker.column(name)[rows[0]] for name in ("x", "y"))
    return np.array([x, y]) / max(np.hypot(x, y), 1e-9)


def _soon_on_it(world, walker, walk, steps):
    """True if it gets onto the crossing within so many seconds, or stands before it."""
    reach = round(_SOON_S / world.step_s)
    for step in (steps[0], steps[-1]):
        row = walker.at(step)
        if row is None or walk not in walker.lane[row:]:
            continue
        if walk in walker.lane[row : row + reach + 1]:
            return True
        if walker.column("speed")[row] < _STANDS_MPS:
            return True
    return False


def _waited(world, walker, walk, step):
    """True if it stood beside the crossing for so long, and then walked over it."""
    row = walker.at(step)
    if row is None or walk not in walker.lane[row:]:
        return False
    first = row - round(_WAITED_S / world.step_s)
    area = walk.rpartition("_")[0] + "_w"
    if first < 0 or not all(edge.startswith(area) for edge in walker.lane[first : row + 1]):
        return False
    return bool((walker.column("speed")[first : row + 1] < _STANDS_MPS).all())
