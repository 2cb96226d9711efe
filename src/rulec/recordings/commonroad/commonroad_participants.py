"""Obstacles of a CommonRoad file as participants of a recording.

Positions in a file may be areas, and headings intervals. The outline of an obstacle then covers
everything that it may occupy; where a single number is needed, it is the middle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import itemgetter

import numpy as np
import shapely

from rulec.recordings import recording as recorded
from rulec.recordings.commonroad.areas import (
    Area,
    Rectangle,
    corners,
    geometry,
    outline_around,
    outline_at,
    read_area,
)
from rulec.recordings.commonroad.states import (
    State,
    TimeExtent,
    read_state,
    read_states,
    read_steps,
)
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.track import Track, TrackOutlines, TrackStates

Outlines = dict[int, recorded.Points]


def read_body(tree: Tree, extent: TimeExtent, *, standing: bool) -> recorded.Participant:
    """The static (``standing``) or dynamic obstacle in an element."""
    kind = read_type(tree)
    body = read_area(tree.child("shape"), body=True)
    states = [read_state(tree.child("initialState"), initial=True)]
    trajectory = None if standing else tree.first("trajectory")
    states += [] if trajectory is None else read_states(trajectory)
    if not standing:
        extent.add([state.step for state in states])
    lamps, shows = _lamps(tree, extent)
    known, outlines = _motion(body, states)
    if not standing and trajectory is None:
        predicted = _predicted(tree, extent)
        outlines = {**outlines, **predicted} if predicted else outlines
    return recorded.Participant(
        tree.id(),
        kind,
        standing,
        known,
        outlines,
        lamps=lamps,
        shows=shows,
        stated_error=_stated_error(states),
    )


def _stated_error(states: Sequence[State]) -> recorded.StatedError | None:
    """The median position and speed errors (m, m/s) given by the states; None if both are 0."""
    if not any(state.area or state.speed_error for state in states):
        return None
    places = [shapely.minimum_bounding_radius(geometry(x.area)) if x.area else 0 for x in states]
    place, speed = np.median(places), np.median([state.speed_error for state in states])
    return recorded.StatedError(float(place), float(speed)) if place or speed else None


def read_environment_obstacle(tree: Tree) -> recorded.Participant:
    """An ``environmentObstacle``: an object that always covers the same area."""
    outlines = {0: corners(geometry(read_area(tree.child("shape"))))}
    return recorded.Participant(tree.id(), read_type(tree), True, {}, outlines)


def read_phantom(tree: Tree, extent: TimeExtent) -> recorded.Participant:
    """A ``phantomObstacle``: a possible participant of which only the occupied areas are known."""
    return recorded.Participant(tree.id(), "unknown", False, {}, _predicted(tree, extent))


def read_type(tree: Tree) -> str:
    """The type of an obstacle."""
    return tree.child("type").one_of(recorded.OBSTACLE_TYPES)


def _motion(
    body: Area, states: Sequence[State]
) -> tuple[Mapping[int, recorded.TrackState], Mapping[int, recorded.Points]]:
    # If the file has two states of one step, the later one holds
    by_step = {state.step: state for state in states}
    only = body[0] if len(body) == 1 else None
    if (
        isinstance(only, Rectangle)
        and only.x == only.y == only.heading == 0
        and all(state.is_exact for state in by_step.values())
    ):
        ordered = sorted(by_step.values(), key=itemgetter(0))
        rows = [(x, y, heading.low, *motion) for _, x, y, _, heading, *motion, _ in ordered]
        track = Track(
            np.array([state.step for state in ordered], dtype=np.int64),
            np.array(rows, dtype=float),
            only.length,
            only.width,
            only.shift,
        )
        return TrackStates(track), TrackOutlines(track)
    outlines = {step: _outline(body, state) for step, state in by_step.items()}
    known = {step: track_state(state, outlines[step]) for step, state in by_step.items()}
    return known, outlines


def _outline(body: Area, state: State) -> recorded.Points:
    if state.is_exact:
        return outline_at(body, state.x, state.y, state.heading.low)
    place = state.area or (Rectangle(0.0, 0.0, state.x, state.y),)
    return outline_around(body, place, *state.heading)


def track_state(state: State, outline: recorded.Points) -> recorded.TrackState:
    """The recorded state.

    An area as its position is replaced by the mean of the outline's points.
    """
    x, y = outline.mean(axis=0).tolist() if state.area else (state.x, state.y)
    return recorded.TrackState(x, y, state.heading.middle, state.speed, state.acceleration)


def _predicted(tree: Tree, extent: TimeExtent) -> Outlines:
    """Time step -> outline of the occupied area; it is constant throughout an interval of time."""
    outlines: Outlines = {}
    occupied = tree.first("occupancySet")
    for occupancy in () if occupied is None else occupied.all("occupancy"):
        steps = read_steps(occupancy.child("time"), extent)
        outline = corners(geometry(read_area(occupancy.child("shape"))))
        outlines.update(dict.fromkeys(steps, outline))
    return outlines


_SIGNALS: Mapping[str, recorded.Lamp] = {
    "indicatorLeft": "left_indicator",
    "indicatorRight": "right_indicator",
    "hazardWarningLights": "hazard_lights",
    "brakingLights": "brake_light",
    "flashingBlueLights": "blue_light",
    "horn": "horn",
}


_LIT: Mapping[str, bool] = {"true": True, "1": True, "false": False, "0": False}


def _lamps(
    tree: Tree, extent: TimeExtent
) -> tuple[dict[int, frozenset[recorded.Lamp]], frozenset[recorded.Lamp]]:
    """Time step -> lit lamps, and the lamps that every signal state mentions."""
    states = tree.all("initialSignalState")[:1]
    if (series := tree.first("signalSeries")) is not None:
        states += series.all("signalState")
    lamps: dict[int, frozenset[recorded.Lamp]] = {}
    shows: frozenset[recorded.Lamp] | None = None
    # An empty signal state means that there is none
    for state in filter(lambda state: state.children, states):
        known = {_SIGNALS[child.name]: child for child in state.children if child.name in _SIGNALS}
        lit = frozenset(lamp for lamp, child in known.items() if _LIT[child.one_of(_LIT)])
        lamps.update(dict.fromkeys(read_steps(state.child("time"), extent), lit))
        shows = frozenset(known) if shows is None else shows & frozenset(known)
    return lamps, shows or frozenset()


_INDICATORS: tuple[recorded.Lamp, ...] = ("left_indicator", "right_indicator")
_FEWEST = 3
"""This many vehicles or more never all indicate to the same side all the time."""


def without_constant_indicators(
    bodies: Sequence[recorded.Participant],
) -> tuple[tuple[recorded.Participant, ...], tuple[str, ...]]:
    """Participants without indicators that are always lit on every vehicle, and remarks on these.

    Such an indicator does not show a lamp: it is a constant in the file, written for instance by a
    converter.
    """
    constant = []
    for lamp in _INDICATORS:
        telling = [body for body in bodies if body.lamps and lamp in body.shows]
        if len(telling) >= _FEWEST and all(
            lamp in lit for body in telling for lit in body.lamps.values()
        ):
            constant.append(lamp)
    if not constant:
        return tuple(bodies), ()
    remarks = [
        f"the {lamp.replace('_', ' ')} of every vehicle is on all the time, so it is ignored"
        for lamp in constant
    ]
    return tuple([_without(body, frozenset(constant)) for body in bodies]), tuple(remarks)


def _without(body: recorded.Participant, gone: frozenset[recorded.Lamp]) -> recorded.Participant:
    lamps = {step: lit - gone for step, lit in body.lamps.items()}
    return replace(body, lamps=lamps, shows=body.shows - gone)
