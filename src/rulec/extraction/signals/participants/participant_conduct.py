"""What participants do, whatever ego does: oncoming, going across, standing, beside the lanes."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.recording_parts import span_of
from rulec.extraction.signals.ego_lanelets import (
    CYCLE_LANE,
    SHOULDER,
    map_contents,
    those_on_lanes,
)
from rulec.extraction.signals.participants.intention_signals import may_have_broken_down
from rulec.extraction.signals.signal_columns import OfObjects
from rulec.extraction.signals.words import word, word_of_objects
from rulec.extraction.tracks.lane_sets import edges
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_ALONG = 0.5
"""Sine of the largest angle to the road at which a participant heads along it."""

_FACES_RAD = np.radians(120.0)
"""Beyond this angle to the road a participant faces ego."""

_TWO_WHEELED = ("motorcycle", "bicycle")

_EDGE_M, _ROOM_M = 0.5, 3.05
"""A parked vehicle is at the edge; the widest vehicle (2.55 m) needs half a metre more to pass."""


@word_of_objects("oncoming")
def oncoming(context: DriveContext) -> Flags:
    """Whether participants come towards ego; see ``comes_towards``."""
    return comes_towards(context)


@once
def comes_towards(context: DriveContext) -> Flags:
    """Mask of participants that move against ego's direction, or wait on lanes of that way."""
    along = context.extents.along
    faces = _faces(context)
    comes = faces & (along * -KMH_PER_MPS >= context.thresholds.standing_kmh)
    others = Cells.at(faces & ~comes)
    np.put(comes, others.places, _waits_elsewhere(context, others))
    return comes


def _faces(context: DriveContext) -> Flags:
    """Mask of participants that face ego, or did and have not turned as far as across the road.

    So that one that swerves as ego gets beside it, as round an island, does not go ego's way.
    """
    turned = np.abs(context.extents.turned)
    faces: Flags = turned > _FACES_RAD
    leans = (turned > np.pi / 2) & ~faces
    rows = (leans.any(axis=1) & faces.any(axis=1)).nonzero()[0]
    if len(rows):
        latest, against = context.spans.latest, turned[rows] > np.pi / 2
        # Which other places are known depends on the drives that are processed together
        counts = context.relevant[rows]
        faces[rows] |= against & (latest(faces[rows] & counts) > latest(~against & counts))
    return faces


def _waits_elsewhere(context: DriveContext, cells: Cells) -> Flags:
    """Mask of cells of drivers and riders that face ego on lanes not of its way.

    They may stand in a queue there. Ego does not overtake them, nor oncoming ones that move, nor
    follow one that waits in a junction for its turn. A body that always stands there, the wrong way
    round, is an obstacle in ego's lanes. One that faces ego and moves away from it reverses, or its
    box drifts: it counts as standing.
    """
    rows = np.unique(cells.rows)
    # By its whole track: which of its places on the road are known depends on other drives
    slow = ~(context.tracks.speed[rows] * KMH_PER_MPS >= context.thresholds.standing_kmh)
    still = context.spans.all(slow)[rows.searchsorted(cells.rows), cells.columns]
    of_type = context.tracks.of_type
    drivers = of_type("vehicle") | of_type("light_rider") | of_type("rail_vehicle")
    moves_elsewhere = cells.of(context.elsewhere) & ~still
    waits: Flags = drivers[cells.rows] & (moves_elsewhere | ~cells.of(context.on_lanes))
    return waits


@word_of_objects("goes_across")
def goes_across(context: DriveContext) -> Truth:
    """Whether participants move across the road more than along it.

    A person or cycle that crosses keeps crossing, even if it stops or is hit, until it leaves the
    road or moves along it. Unknown where the tolerance of speeds decides.
    """
    least = context.thresholds.standing_kmh / KMH_PER_MPS
    along, across = np.abs(context.extents.along), np.abs(context.extents.across)
    goes: Flags = (across >= least) & (across > along)
    # The error of a difference of two speeds
    wrong = context.tolerances.joint(context.tracks.speed_error, context.tracks.speed_error)
    unsure = (np.maximum(along, across) >= least) & (np.abs(across - along) <= wrong)
    users = context.tracks.of_type("vulnerable_user").nonzero()[0]
    if len(users):
        off = _mostly_along(context, users) | ~context.tracks.on_lane[users]
        went = goes[users] & ~unsure[users]
        goes[users] |= context.spans.latest(goes[users]) > context.spans.latest(off)
        unsure[users] &= context.spans.latest(went) <= context.spans.latest(off)
        present = context.tracks.present[users]
        known, away = map(context.spans.latest, ((goes[users] | off) & present, ~present))
        unsure[users] |= _appears_there(context, users, away) & (known <= away)
    return Truth.known(goes).unknown_at(unsure)


def _appears_there(context: DriveContext, rows: NDArray[intp], away: NDArray[intp]) -> Flags:
    """Mask of participants in ``rows`` first recorded in the road, after the recording's start.

    Or recorded there again after the states in which they were last ``away``. Such a track may
    continue the one of a participant that went across.
    """
    first, bodies = context.surroundings.whole.first, context.tracks.participants
    later = [span_of(bodies[row])[0] > first for row in rows.tolist()]
    appears = np.array(later)[:, None] | (away >= context.spans.first)
    found: Flags = appears & context.tracks.on_lane[rows]
    return found


def _mostly_along(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask of participants in ``rows`` that have moved along the road in most recent steps.

    By steps: in means over a second, a collision that displaces a body at once lasts as long.
    """
    least, step_s = context.thresholds.standing_kmh / KMH_PER_MPS, context.recording.step_s
    others, spans = context.extents, context.spans
    along, across = others.s[rows], others.d_min[rows] + others.d_max[rows]
    s, d = (np.abs(values - spans.before(values)) for values in (along, across / 2))
    turns = (s >= least * step_s) & (s > d)
    steps = max(round(context.thresholds.smoothing_s / step_s), 1)
    return 2 * spans.count_of_last(turns, steps) > steps


@word_of_objects("stopped")
def stopped(context: DriveContext) -> Flags:
    """Whether participants stand."""
    return context.standing


@word_of_objects("parked")
def parked(context: DriveContext) -> Truth:
    """Whether participants are parked; unknown for those that may have broken down."""
    standing = [body.standing for body in context.tracks.participants]
    parked = _constant(context, standing) | _stays_aside(context)
    return Truth(parked, parked | may_have_broken_down(context))


def _stays_aside(context: DriveContext) -> Flags:
    """Mask of vehicles that stand aside for as long as they are recorded.

    Their middles are beside the lanes of ego's road, or their sides at the road's edge with room
    for all others in their lane. Vehicles that wait in a lane do not stand aside, however long.
    """
    vehicles = context.tracks.of_type("vehicle").nonzero()[0]
    aside, (first, end) = np.zeros(context.relevant.shape, dtype=bool), context.lane_edges
    still = vehicles[context.stays[vehicles]]
    if len(still):
        others = context.extents.part(still, slice(None))
        waits = context.surroundings.waits[context.tracks.rows[still]]
        on_rails = context.tracks.of_type("rail_vehicle")[still][:, None]
        out = (others.middle_from(first) < 0) | (others.middle_from(end) > 0)
        # Nobody that waits in a lane of the other direction is parked beside ego's
        out &= ~(waits[:, None] & (on_rails | (np.abs(others.turned) > np.pi / 2)))
        wide = [context.tracks.participants[row].type not in _TWO_WHEELED for row in still.tolist()]
        out |= np.array(wide)[:, None] & _at_edge(others, context.there[still])
        aside[still] = context.spans.all(out | ~context.relevant[still])
    return aside


def _at_edge(others: RoadExtents, there: Flags) -> Flags:
    """Mask of bodies at an edge of the lanes, in a lane that has room beside them.

    ``there``: the lanes (last axis) that exist at their places.
    """
    first, end = edges(there)
    right = (others.from_bound(first)[0] < _EDGE_M) & (others.from_bound(first + 1)[1] < -_ROOM_M)
    left = (others.from_bound(end)[1] > -_EDGE_M) & (others.from_bound(end - 1)[0] > _ROOM_M)
    at_edge: Flags = there.any(axis=2) & (right | left)
    return at_edge


@word_of_objects("on_shoulder")
def on_shoulder(context: DriveContext) -> Truth:
    """Whether vehicles heading along the road stand beside its lanes or are on a hard shoulder.

    Only at the near side: at the far one they may be on lanes of the other direction. A vehicle
    that moves beside the lanes may be on a lane that the road does not contain.
    """
    others, there = context.extents, context.there
    first, end = edges(there)
    right, left = -others.middle_from(first), others.middle_from(end)
    beyond = right if context.side == "right" else left
    on_wheels = context.tracks.of_type("vehicle") & ~context.tracks.of_type("rail_vehicle")
    vehicles = on_wheels[:, None] & there.any(axis=2)
    along = vehicles & ~context.elsewhere & (np.abs(np.sin(others.turned)) < _ALONG)
    inside = those_on_lanes(context, SHOULDER, along)
    stands = context.standing
    loose = context.tolerances.place_m + np.abs(context.map_offset_m)
    beside = along & (inside | (stands & (beyond > 0)))
    unsure = along & ~inside & ((np.abs(beyond) < loose) | (~stands & (beyond > 0)))
    return Truth.known(beside).unknown_at(unsure)


@word_of_objects("two_wheeled")
def two_wheeled(context: DriveContext) -> Flags:
    """Whether participants ride on two wheels."""
    two_wheeled = [body.type in _TWO_WHEELED for body in context.tracks.participants]
    return _constant(context, two_wheeled)


def _constant(context: DriveContext, flags: list[bool]) -> Flags:
    return np.array(flags, dtype=bool)[:, None].repeat(context.states, axis=1)


@word("in_the_road")
def in_the_road(context: DriveContext) -> OfObjects:
    """Whether people are on a lane; unknown at the outermost edges there, where they may wait.

    Unknown, too, for riders on a cycle lane: it may be a path beside the road.
    """
    unsure, users = np.zeros_like(context.relevant), context.tracks.of_type("vulnerable_user")
    on_lane = context.tracks.on_lane & users[:, None]
    if len(rows := on_lane.any(axis=1).nonzero()[0]):
        error = context.tolerances.place_m + np.abs(context.map_offset_m)
        own, states = on_lane[rows].nonzero()
        least = np.maximum(context.thresholds.changed_m, error)[states]
        people = context.extents.part(rows, slice(None)).at(own[None], states[None])
        near, at_edge = context.thresholds.side_road_m, np.zeros((1, len(own)), dtype=bool)
        # Where they are, not where ego is: in a junction there are fewer lanes than around it
        for place in (people.s - near, people.s, people.s + near):
            there = context.road.lanes.existing_at(place)
            for edge in edges(there):
                low, high = people.from_bound(edge)
                at_edge |= there.any(axis=2) & (np.abs(low + high) / 2 <= least)
        unsure[rows[own], states] = at_edge[0]
    if CYCLE_LANE in map_contents(context).types:
        rides = context.tracks.of_type("light_rider")[:, None] & context.tracks.on_lane
        unsure |= those_on_lanes(context, CYCLE_LANE, rides)
    return OfObjects(
        Truth.known(context.tracks.on_lane).unknown_at(unsure & context.tracks.on_lane), users
    )
