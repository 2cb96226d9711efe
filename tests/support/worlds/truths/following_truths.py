"""Tailgating: the gap to SUMO's leader, against what both need to stop."""

import numpy as np

from support.worlds.facts import graded
from support.worlds.world_state import LENGTH_M

REACTION_S, BRAKING_MPS2 = 1.0, 8.0
"""The numbers of this reading of the law: as documented, not as programmed."""

_SURELY_M, _PERHAPS_M, _LEAST_S = 0.4, 0.7, 0.6
"""In a bend bodies are a little nearer to each other than along the middles of lanes."""

_NEAR_M = 150.0
_FALLS_BACK_S = 3.0
"""Who is put onto the road has not chosen its distance, no more than one whom another cuts off."""
_ALIKE, _ASIDE_M = 0.1, 6.0
"""The cosine between headings of two who will follow each other, as where roads lead to a ring at
84 degrees, and how far one is beside the other's."""


_STANDS_MPS = 0.3

_HEADWAY_S = {"gb": 2.0, "fr": 2.0, "ie": 2.0}
"""Where the law counts seconds instead."""

_LEAVES_MPS = {"fr": 0.8, "gb": 0.8, "ie": 0.8}
"""Where it asks of who follows, and one that is faster by 3 km/h is not followed but leaves."""


def needed(book, speed, leading):
    """The gap (m) in which who reacts after a second still stops behind the other."""
    if book in _HEADWAY_S:
        return _HEADWAY_S[book] * speed
    return np.maximum(speed * REACTION_S + (speed**2 - leading**2) / (2 * BRAKING_MPS2), 0.0)


_TOWNS, _FAST_ROADS = "residential", "motorway"


def _asked_for(world, track):
    """Where the rule holds for sure, and where it may; in Britain not in towns."""
    kinds = [world.net.edges[world.net.lanes[lane].edge].type for lane in track.lane]
    if world.book != "gb":
        return True, True
    holds, not_here = (np.array([word in kind for kind in kinds]) for word in (_FAST_ROADS, _TOWNS))
    # Within junctions the roads that lead there count
    return holds, ~not_here & ~(track.inside & bool(not_here.any()))


def following_facts(world):
    """Too short a gap; sure to a leader on ego's own way, nobody changing lanes."""
    for track in world.vehicles.values():
        speed, gap = track.column("speed"), track.column("gap")
        leading = track.column("leader_speed")
        perhaps_led, surely_led = _led(world, track)
        led = perhaps_led & (gap > -1)
        short = np.where(led, needed(world.book, speed, leading) - gap, -np.inf)
        steady = led & surely_led & ~world.changing[track.id]
        steady &= ~_leader_changing(world, track)
        steady &= leading - speed < _LEAVES_MPS.get(world.book, np.inf)
        steady[: round(_FALLS_BACK_S / world.step_s)] = False
        steady &= ~_stops_behind(world, speed, leading, gap)
        possible = (short > -_PERHAPS_M) | _beside_short(world, track)
        possible |= _merging_short(world, track)
        surely, perhaps = _asked_for(world, track)
        masks = (surely & steady & (short > _SURELY_M), perhaps & possible, _LEAST_S)
        yield from graded(world, track, "following_distance", masks)


def _stops_behind(world, speed, leading, gap):
    """Where ego brakes for one that has stood for a second, and can stop behind it.

    The law asks for a distance to one that drives ahead. Who brakes for one that stands has seen
    it, and needs no time to react; who does not brake yet does.
    """
    second = round(REACTION_S / world.step_s)
    stands = leading < _STANDS_MPS
    stood = np.array([stands[max(k - second, 0) : k + 1].all() for k in range(len(stands))])
    brakes = np.append(False, np.diff(speed) < 0)
    return stood & brakes & (gap >= speed**2 / (2 * BRAKING_MPS2))


def _led(world, track):
    """Where the leader may be ahead on ego's way, and where it is so for sure.

    In a junction SUMO's leader may be one that crosses: it neither has come over ego's lane nor is
    on one that ego drives later. One on the same lane of a road is surely ahead; so is one that has
    been the leader for ``_FALLS_BACK_S``, over the lanes that ego is on and drives next.
    """
    perhaps, surely = np.zeros((2, len(track.lane)), dtype=bool)
    longest = round(_FALLS_BACK_S / world.step_s)
    for row, (lane, name) in enumerate(zip(track.lane, track.leader, strict=True)):
        other = world.vehicles.get(name)
        k = None if other is None else other.at(track.step[row])
        if k is None:
            continue
        driven, ahead = other.lane[: k + 1], track.lane[row:]
        perhaps[row] = lane in driven or other.lane[k] in ahead
        for_long = row >= longest and set(track.leader[row - longest : row]) == {name}
        on_road = not lane.startswith(":") and other.lane[k] == lane
        surely[row] = on_road or (for_long and _precedes(driven, ahead))
    return perhaps, surely


def _precedes(driven, ahead):
    """True if one has driven the first of the lanes that lie ahead of another, and those after."""
    if ahead[0] not in driven:
        return False
    since = len(driven) - 1 - driven[::-1].index(ahead[0])
    way, ahead = list(dict.fromkeys(driven[since:])), list(dict.fromkeys(ahead))
    return way == ahead[: len(way)]


def _leader_changing(world, track):
    found = []
    for row, name in enumerate(track.leader):
        k = world.vehicles[name].at(track.step[row]) if name else None
        found.append(k is not None and world.changing[name][k])
    return np.array(found)


def _beside_short(world, track):
    """Rows where somebody on a lane beside, or in a junction, would be too near, had it changed."""
    mask = np.zeros(len(track.lane), dtype=bool)
    own_change = world.changing[track.id]
    speed, pos = track.column("speed"), track.column("pos")
    for other in world.vehicles.values():
        if other is track:
            continue
        shift = track.step[0] - other.step[0]
        if not _share_edges(world, track, other):
            continue
        rows = np.arange(len(track.lane))
        theirs = rows + shift
        rows = rows[(theirs >= 0) & (theirs < len(other.lane))]
        if len(rows) == 0:
            continue
        theirs = rows + shift
        lanes = zip(rows, theirs, strict=True)
        beside = np.array([_neighbours(world, track.lane[a], other.lane[b]) for a, b in lanes])
        moves = own_change[rows] | world.changing[other.id][theirs]
        gap = other.column("pos")[theirs] - LENGTH_M - pos[rows]
        need = needed(world.book, speed[rows], other.column("speed")[theirs])
        near = (gap > -LENGTH_M) & (gap < _NEAR_M) & (gap < need + _PERHAPS_M)
        mask[rows[beside & moves & near]] = True
    return mask


def _merging_short(world, track):
    """Rows where, at a junction, somebody who comes onto ego's way would be too near."""
    mask = np.zeros(len(track.lane), dtype=bool)
    inside = track.inside
    for other in world.vehicles.values():
        rows = np.arange(len(track.lane))
        theirs = rows + track.step[0] - other.step[0]
        there = (theirs >= 0) & (theirs < len(other.lane))
        if other is track or not there.any() or not set(track.lane) & set(other.lane):
            continue
        rows, theirs = rows[there], theirs[there]
        their_inside = other.inside[theirs]
        x, y, angle = (
            other.column(name)[theirs] - track.column(name)[rows] for name in ("x", "y", "angle")
        )
        own = np.radians(track.column("angle")[rows])
        ahead, aside = x * np.sin(own) + y * np.cos(own), x * np.cos(own) - y * np.sin(own)
        alike = np.cos(np.radians(angle)) > _ALIKE
        need = needed(world.book, track.column("speed")[rows], other.column("speed")[theirs])
        near = (ahead > 0) & (ahead - LENGTH_M < need + _PERHAPS_M) & (np.abs(aside) < _ASIDE_M)
        mask[rows[(inside[rows] | their_inside) & alike & near]] = True
    return mask


def _share_edges(world, one, other):
    """True if both are on roads of several lanes at some time."""
    edges = {world.net.lanes[lane].edge for lane in set(one.lane)}
    edges &= {world.net.lanes[lane].edge for lane in set(other.lane)}
    return any(len(world.net.edges[edge].lanes) > 1 for edge in edges)


def _neighbours(world, one, other):
    one, other = world.net.lanes[one], world.net.lanes[other]
    return one.edge == other.edge and abs(one.index - other.index) == 1
