"""Labels of recorded traffic from raw places: sure where one need not look twice."""

import numpy as np

from support.worlds.facts import Fact, runs

LABELLED = "speed_limit", "following_distance", "red_light", "near_side_passing"
DRIVERS = frozenset({"car", "truck", "bus", "motorcycle", "taxi", "priorityVehicle"})
REACTION_S, BRAKING_MPS2 = 1.0, 8.0
_SPEED_MPS, _SPEED_S = 0.6, 1.0
_GAP_M, _GAP_S = 1.5, 0.8
_CUT_IN_S = 2.0
"""Of a pair that nobody has seen for longer, one may have cut in just before."""
_IN_LANE_M, _ALIKE_DEG = 0.9, 15.0
_BESIDE_LANE_M = 2.8
_LIGHT_S = 0.5
_QUEUE_M, _QUEUE, _FLOWS_MPS = 110.0, 3, 18.0
_BESIDE_M, _AWAY_M, _LEVEL_M = (2.2, 5.5), 16.0, 1.0
_AROUND_S = 2.0
_TOWN_MPS = 50 / 3.6
"""Where there is no sign one does not know the limit; so fast it may be broken, as in towns."""


def labels(recording):
    """Facts of all drivers in a recording under the rules of this module."""
    for track in recording.tracks.values():
        if track.type in DRIVERS:
            for rule in (speeding, tailgating, red_lights, near_side):
                yield from rule(recording, track)


def _graded(recording, track, rule, masks):
    sure, possible, least_s = masks
    for begin, end in runs(possible):
        long = [b - a for a, b in runs(sure[begin : end + 1])]
        at = ((track.first + k) * recording.step_s for k in (begin, end))
        yield Fact(track.id, rule, *at, max(long, default=-1) * recording.step_s >= least_s)


def speeding(recording, track):
    """Faster than the signs of all lanelets where it is, from places a second apart."""
    lowest = np.full(len(track.places), np.inf)
    highest = np.zeros(len(track.places))
    for key, inside in track.on.items():
        limits = recording.lanelets[key].limits
        lowest[inside] = np.minimum(lowest[inside], min(limits, default=np.inf))
        highest[inside] = np.maximum(highest[inside], max(limits, default=np.inf))
    highest[highest == 0.0] = np.inf
    reach = round(1.0 / recording.step_s)
    lowest, highest = _around(lowest, reach, min), _around(highest, reach, max)
    speed = track.speeds(recording.step_s)
    if not recording.motorway or recording.abroad:
        lowest[np.isinf(lowest)] = _TOWN_MPS
    masks = (speed > highest + _SPEED_MPS, speed > lowest - 0.1, _SPEED_S)
    yield from _graded(recording, track, "speed_limit", masks)


def _around(values, reach, choose):
    padded = np.pad(values, reach, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1)
    return (np.min if choose is min else np.max)(windows, axis=1)


def tailgating(recording, track):
    """Too near to stop behind one ahead in the same lanelet (R_G1 of Maierhofer et al.)."""
    sure = np.zeros(len(track.places), dtype=bool)
    possible = sure.copy()
    speed = track.speeds(recording.step_s)
    for other in recording.tracks.values():
        rows, theirs = _together(track, other)
        if other is track or len(rows) == 0:
            continue
        x, y = (other.places[theirs] - track.places[rows]).T
        own = track.headings[rows]
        ahead, aside = x * np.cos(own) + y * np.sin(own), y * np.cos(own) - x * np.sin(own)
        leading = other.speeds(recording.step_s)[theirs]
        need = speed[rows] * REACTION_S + (speed[rows] ** 2 - leading**2) / (2 * BRAKING_MPS2)
        short = np.maximum(need, 0.0) - (ahead - (track.length + other.length) / 2)
        turned = np.degrees(_turned(other.headings[theirs] - own))
        # A bend of the road takes the one ahead to the side
        cone = np.abs(aside) < 3.0 + 0.3 * np.abs(ahead)
        near = (ahead > 0) & cone & (short > -_GAP_M) & (np.abs(turned) < 100)
        near &= ~_beside_lanelet(recording, track, rows, other.places[theirs])
        possible[rows[near]] = True
        same = _same_lanelet(recording, track, other, rows)
        alike = np.abs(turned) < _ALIKE_DEG
        surely = near & same & alike & (short > _GAP_M)
        for begin, end in runs(surely):
            surely[begin : end + 1] = end * recording.step_s >= _CUT_IN_S
        sure[rows[surely]] = True
    masks = (sure, possible, _GAP_S)
    yield from _graded(recording, track, "following_distance", masks)


def _same_lanelet(recording, track, other, rows):
    """Where both are well within one lanelet."""
    theirs = rows + track.first - other.first
    same = np.zeros(len(rows), dtype=bool)
    for key in track.on.keys() & other.on.keys():
        both = track.on[key][rows] & other.on[key][theirs]
        if both.any():
            lanelet = recording.lanelets[key]
            aside = np.abs(lanelet.frame(track.places[rows])[1])
            their_aside = np.abs(lanelet.frame(other.places[theirs])[1])
            same |= both & (aside < _IN_LANE_M) & (their_aside < _IN_LANE_M)
    return same


def _beside_lanelet(recording, track, rows, places):
    """Where places are level with a lanelet that the track is in, and well beside it."""
    found = np.zeros(len(rows), dtype=bool)
    for key, inside in track.on.items():
        if inside[rows].any():
            lanelet = recording.lanelets[key]
            along, aside = lanelet.frame(places)
            level = (along > 0) & (along < lanelet.length)
            found |= inside[rows] & level & (np.abs(aside) > _BESIDE_LANE_M)
    return found


def _together(track, other):
    first, last = max(track.first, other.first), min(track.last, other.last)
    steps = np.arange(first, last + 1)
    return steps - track.first, steps - other.first


def _turned(angles):
    return (angles + np.pi) % (2 * np.pi) - np.pi


def red_lights(recording, track):
    """The front crosses the stop line, or the end of a lanelet without one, at red."""
    heading = np.stack((np.cos(track.headings), np.sin(track.headings)), axis=1)
    fronts = track.places + track.length / 2 * heading
    for key, inside in track.on.items():
        lanelet = recording.lanelets[key]
        if not lanelet.lights or not inside.any():
            continue
        along, aside = lanelet.frame(fronts)
        line = lanelet.length
        if lanelet.stop_line is not None:
            line = float(lanelet.frame(lanelet.stop_line.mean(axis=0)[None])[0][0])
        crossed = np.flatnonzero((along[:-1] < line) & (along[1:] >= line)) + 1
        for k in crossed:
            if not (inside[max(0, k - 3) : k + 1].any() and abs(aside[k]) < 2.5):
                continue
            at = (track.first + k) * recording.step_s
            colours = _colours(recording, lanelet, track.first + k)
            if colours & {"red", "redYellow", None}:
                gone = along[-1] > line + track.length and along[k:].min() > line - 0.2
                # Without a line in the map one may stop beyond the lanelet's end
                gone &= lanelet.stop_line is not None or along[-1] > line + 15.0
                yield Fact(track.id, "red_light", at, at, bool(colours == {"red"} and gone))


def _colours(recording, lanelet, step):
    reach = max(1, round(_LIGHT_S / recording.step_s))
    steps = range(step - reach, step + reach + 1)
    return {recording.colour(light, k) for light in lanelet.lights for k in steps}


def near_side(recording, track):
    """Past one on the next lane to the left, in free flow on a road of one direction."""
    speed = track.speeds(recording.step_s)
    for other in recording.tracks.values():
        rows, theirs = _together(track, other)
        if other is track or len(rows) < 3 or other.type not in DRIVERS:
            continue
        x, y = (track.places[rows] - other.places[theirs]).T
        own = other.headings[theirs]
        ahead, aside = x * np.cos(own) + y * np.sin(own), y * np.cos(own) - x * np.sin(own)
        reach = (track.length + other.length) / 2
        alike = np.abs(_turned(track.headings[rows] - own)) < np.radians(60)
        level = (np.abs(ahead) <= reach - _LEVEL_M) & alike & (np.abs(aside) < _AWAY_M)
        for begin, end in runs(level):
            if ahead[begin] > 0 or ahead[end] < 0 or aside[begin : end + 1].min() > 0:
                continue
            whole = begin > 0 and end < len(rows) - 1 and (np.abs(ahead[[0, -1]]) > reach + 1).all()
            steady = (-aside[begin : end + 1] > _BESIDE_M[0]).all()
            steady &= (-aside[begin : end + 1] < _BESIDE_M[1]).all()
            free = speed[rows[begin : end + 1]].min() > _FLOWS_MPS
            free &= other.speeds(recording.step_s)[theirs[begin : end + 1]].min() > _FLOWS_MPS
            free &= not _dense(recording, track, rows[begin])
            sure = whole and steady and free and recording.motorway
            around = [float(track.first + rows[k]) * recording.step_s for k in (begin, end)]
            at = around[0] - _AROUND_S, around[1] + _AROUND_S
            yield Fact(track.id, "near_side_passing", *at, bool(sure), other.id)


def _dense(recording, track, row):
    """True if enough vehicles are about that there may be queues."""
    step = track.first + row
    near = 0
    for other in recording.tracks.values():
        k = other.at(step)
        near += k is not None and np.hypot(*(other.places[k] - track.places[row])) < _QUEUE_M
    return near >= 2 * _QUEUE
