"""Priority: who drove over a junction before one to whom the net's `request` bits make it yield."""

import numpy as np

from support.worlds.facts import Fact
from support.worlds.world_state import LENGTH_M, WIDTH_M

_HINDERED_S, _UNHINDERED_S, _FREE_S = 0.85, 1.2, 3.5
_INTO_S, _BEHIND_S = 0.55, 0.1
"""Around the limits of the rules, 1 s and 0.3 s, as every second state tells times to 0.1 s, and
half a width by which the area is too long at its ends takes another 0.1 s each. Who gets there once
the other one has left has let it pass."""

_SLOWED = 0.9
"""Who keeps more of its speed has not been made to brake."""

_ABOUT_S = 0.3
"""Who gets there first by less gets there together with the other."""

_AT_LINE_M = 0.1
"""Lines of one junction lie apart by so little in the simulator's net and on a map made of it."""

_MOVING_MPS, _STOPS_MPS = 3.0, 1.0
_APART_M = WIDTH_M + 0.2
_SIDEWAYS_DEG, _ABOUT_DEG = (40.0, 140.0), 10.0
_TOWARDS_DEG = (40.0, 50.0)


def right_facts(world):
    """Where nothing but right before left holds."""
    for crossing, other, grade, at in _conflicts(world):
        kind = world.net.junctions[crossing.link.junction].get("type")
        side = _comes_from(world, crossing.link, other.link)
        if kind == "right_before_left" and _sideways(side, _ABOUT_DEG):
            sure = grade and _sideways(side)
            yield Fact(crossing.track.id, "junction_priority", *at, sure, other.track.id)


def give_way_facts(world):
    """Where a sign makes a road give way."""
    yield from _signed_facts(world, "m", "give_way_sign")


def stop_give_way_facts(world, rule):
    """Where a road has to stop, and to give way then; where all have to nobody has priority."""
    yield from _signed_facts(world, "s", rule)


def _signed_facts(world, letter, rule):
    for crossing, other, grade, at in _conflicts(world):
        link = crossing.link
        side = abs(_comes_from(world, link, other.link))
        # Those who come from ahead have the same sign: that is another rule's. The ring of a
        # roundabout is the main road of each that leads to it, at whatever angle they meet
        to_ring = _enters_before(world, link, other.link)
        if _all_are(world, link, letter) and (to_ring or _sideways(side, _ABOUT_DEG)):
            sure = grade and (to_ring or _sideways(side))
            yield Fact(crossing.track.id, rule, *at, sure, other.track.id)


def _sideways(side_deg, more_deg=0.0):
    """True if one comes from the right, at an angle of so much more or less than usual."""
    return _SIDEWAYS_DEG[0] - more_deg < side_deg < _SIDEWAYS_DEG[1] + more_deg


def roundabout_facts(world):
    """Who enters a roundabout before one that is on it."""
    for crossing, other, grade, at in _conflicts(world):
        if _enters_before(world, crossing.link, other.link):
            yield Fact(crossing.track.id, "roundabout_priority", *at, grade, other.track.id)


def oncoming_facts(world):
    """Who turns to the far side before one that comes towards it."""
    far = "R" if world.net.lefthand else "L"
    for crossing, other, grade, at in _conflicts(world):
        across = crossing.link.turn.upper() == far and other.link.turn.upper() != far
        side = abs(_comes_from(world, crossing.link, other.link))
        if across and side < _TOWARDS_DEG[1] and not _at_red(world, other):
            sure = grade and side < _TOWARDS_DEG[0] and not _stops_later(world, crossing, other)
            own, _ = conflict_area(world.net, crossing.link, other.link)
            # It is in the way when it gets there, which may be long after it entered
            begin, end = _occupied(world, crossing, own)
            span = at[0], max(at[1], end if np.isfinite(end) else begin)
            yield Fact(crossing.track.id, "oncoming_priority", *span, sure, other.track.id)


def _stops_later(world, crossing, other):
    """True where all have to stop, and the other one enters later: who comes first goes first."""
    own, theirs = (world.time(one.track, one.row) for one in (crossing, other))
    return other.link.state == "w" and theirs > own


def _at_red(world, crossing):
    """True if it has come past a red light."""
    states = world.lights.get(crossing.link.light, {})
    shown = states.get(crossing.track.step[crossing.row], "")
    return bool(shown) and shown[crossing.link.light_index] == "r"


def _conflicts(world):
    """Pairs of ways over a junction of which the first has to yield, and does not, or may not."""
    by_junction = {}
    for crossing in world.crossings:
        by_junction.setdefault(crossing.link.junction, []).append(crossing)
    for junction, ways in by_junction.items():
        yields = world.net.yields[junction]
        for one in ways:
            for other in ways:
                if one.track is not other.track and other.link.number in yields.get(
                    one.link.number, ()
                ):
                    grade = _grade(world, one, other)
                    if grade is not None:
                        # Who stands at the line may be over it by another map
                        close = world.along(one)[: one.row] >= -_AT_LINE_M
                        stands = int(close[::-1].argmin()) if not close.all() else 0
                        at = world.time(one.track, one.row)
                        yield one, other, grade, (at - stands * world.step_s, at)


def _grade(world, one, other):
    """True for a violation, False where one cannot tell, None for none."""
    within = conflict_area(world.net, one.link, other.link)
    if within is None:
        return None
    own = _occupied(world, one, within[0])
    theirs = _occupied(world, other, within[1])
    if own[0] < theirs[0]:
        spare = theirs[0] - own[1]
        # Whose track ends before it gets there would not have come earlier
        if min(theirs[0], other.track.step[-1] * world.step_s) - own[1] >= _FREE_S:
            return None
        row = other.track.at(one.track.step[one.row])
        if row is None:
            return False
        speed = other.track.column("speed")
        ends = theirs[0] == np.inf
        reaches = len(speed) - 1 if ends else other.track.at(round(theirs[0] / world.step_s))
        until = max(other.row, reaches or 0)
        on_its_way = speed[row : until + 1]
        waited = on_its_way.min(initial=np.inf)
        kept = (on_its_way / np.maximum.accumulate(on_its_way).clip(1e-9)).min(initial=np.inf)
        # Who had to stop for it, or to wait for others, may have had its own reasons
        moved = speed[row] > _MOVING_MPS and waited > _MOVING_MPS
        if spare > _UNHINDERED_S and moved and kept > _SLOWED:
            return None
        return bool(spare < _HINDERED_S and moved)
    spare = own[0] - theirs[1]
    if spare >= _BEHIND_S:
        return None
    if one.link.end == other.link.end:
        # It joined behind it, as near as its speed let it
        return False if own[0] - theirs[0] < _ABOUT_S else None
    # It drove into the side of one that was in the junction already. Who stops for it, a little too
    # far ahead, has let it pass all the same
    during = own[0], theirs[1]
    drives = _moves(world, one, during, _STOPS_MPS) and _moves(world, other, during, _MOVING_MPS)
    return bool(spare < -_INTO_S and drives)


def _moves(world, crossing, during, least_mps):
    """True if it is faster than so much all the time from a time to another."""
    track = crossing.track
    times = np.array(track.step) * world.step_s
    there = (times >= during[0]) & (times <= during[1])
    return track.column("speed")[there].min(initial=np.inf) > least_mps


def conflict_area(net, one, other):
    """From where to where on each way the other is too near to be there, too; None if nowhere."""
    ways = [_way(net, link) for link in (one, other)]
    distance = np.hypot(*(ways[0][0][:, None] - ways[1][0][None]).T).T
    near = distance < _APART_M
    if not near.any():
        return None
    found = []
    for axis, (_, along) in enumerate(ways):
        places = along[near.any(axis=1 - axis)]
        merges = one.end == other.end
        found.append((places[0], np.inf if merges and one.end else places[-1]))
    if one.end == other.end:
        # Beyond the junction they follow each other: what counts is who gets there first
        found = [(begin, ways[k][1][-1]) for k, (begin, _) in enumerate(found)]
    return found


def _way(net, link):
    """Places on a way over a junction each 0.25 m, and how far on they are."""
    shape = np.concatenate([net.lanes[lane].shape for lane in link.inner])
    length = sum(net.lanes[lane].length for lane in link.inner)
    steps = np.append(0.0, np.hypot(*np.diff(shape, axis=0).T).cumsum())
    along = np.linspace(0.0, steps[-1], max(2, int(steps[-1] / 0.25)))
    places = np.stack([np.interp(along, steps, shape[:, axis]) for axis in (0, 1)], axis=1)
    return places, along * length / max(steps[-1], 1e-9)


def _occupied(world, crossing, area):
    """From when to when a body is in an area of its way; infinite where it has not left it."""
    placed, track = world.along(crossing), crossing.track
    times = np.array(track.step) * world.step_s
    there = ~np.isnan(placed)
    placed, times = placed[there], times[there]
    inside = np.flatnonzero(placed >= area[0])
    gone = np.flatnonzero(placed - LENGTH_M > area[1])
    begin = times[inside[0]] if len(inside) else np.inf
    return begin, times[gone[0]] if len(gone) else np.inf


def _comes_from(world, own, other):
    """Where the other comes from: degrees to the right of ahead, negative to the left."""
    ahead, theirs = (_heading(world.net.lanes[link.start].shape) for link in (own, other))
    turned = np.degrees(theirs - ahead - np.pi)
    return float((-turned + 180.0) % 360.0 - 180.0)


def _heading(shape):
    return np.arctan2(*(shape[-1] - shape[-2])[::-1])


def _all_are(world, link, letter):
    """True if the whole road has SUMO's letter of a sign: its way straight on does, too."""
    ways = [one for one in world.net.links.values() if one.start == link.start]
    return all(one.state == letter for one in ways)


def _enters_before(world, link, other):
    """True if one way leads onto a roundabout, and the other one is on it already."""
    enters = _on_ring(world, link.end) and not _on_ring(world, link.start)
    return enters and _on_ring(world, other.start)


def _on_ring(world, lane):
    edge = world.net.edges[world.net.lanes[lane].edge]
    return edge.start.startswith("r") and edge.end.startswith("r") and "_r" in f"_{edge.end}"
