"""The context of one drive, made by the passes before the signals, for tests of a single signal."""

from dataclasses import replace

import numpy as np

from rulec.extraction.context_arrays import EgosOnRoad, drives_context
from rulec.extraction.tracks.driven_road import DrivenRoads
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.extraction.tracks.road_extents import road_extents
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from rulec.scenario.recorded.junction_lanelets import junction_lanelets
from support.builders.recordings import vehicle
from support.signal_arrays import said, unknown_in

EGO = "7"


def driven_road(found, route, junctions=frozenset()):
    """The road of a chain of lanelets."""
    road, _ = DrivenRoads(found, junctions).along(route)
    return road


def context_of(
    found, route=("1",), side="right", ego=EGO, elsewhere=None, until=None, **thresholds
):
    """The context of ego's drive along a chain of lanelets, while ego is in the recording.

    Or up to before a step, ``until``. ``elsewhere``: flags of participants by step that drive on
    other roads.
    """
    limits = replace(USUAL, **thresholds)
    tracks = tracks_of(found, limits)
    road = driven_road(found, route, junction_lanelets(found))
    row = [body.id for body in tracks.participants].index(ego)
    columns = np.flatnonzero(tracks.present[row])
    if elsewhere is None:
        elsewhere = np.zeros(tracks.present.shape, dtype=bool)
    extents = road_extents(tracks, road)
    around = Surroundings(found, tracks, limits)
    moving = around.in_traffic
    places = RoadPlaces(road, tracks, extents, limits, elsewhere=elsewhere, in_traffic=moving)
    driven = slice(int(columns[0]), int(columns[-1]) + 1 if until is None else until)
    egos = EgosOnRoad(places, [row], [driven], own=around)
    return drives_context(around, places, side, egos)


def told_on_both_sides(signals, found, route, **thresholds):
    """The words of a pass, unknown ones as "?"; they have to be the same in the mirror."""
    sides = [
        signals(context_of(found, route, **thresholds)),
        signals(context_of(mirrored_recording(found), route, "left", **thresholds)),
    ]
    told = []
    for side in sides:
        words = {}
        for name in {**side.world, **side.about}:
            words[name] = np.where(unknown_in(side, name), "?", said(side, name)).tolist()
        told.append(words)
    assert told[0] == told[1]
    return told[0]


def steady(number, x, y, speed=10.0, steps=4, first=0, step_s=0.5, **more):
    """Places of a participant at constant speed along the x axis, for ``vehicle``."""
    heading = more.pop("heading", 0.0 if speed >= 0 else float(np.pi))
    places = {first + k: (x + speed * step_s * k, y) for k in range(steps)}
    return vehicle(number, places, speed=abs(speed), heading=heading, **more)


def line(speed, count, y=0.0, start=10.0, apart=10.0, number=20):
    """Vehicles one behind the other, at the same speed."""
    return [steady(number + k, start + apart * k, y, speed=speed) for k in range(count)]


def along(number, path, way, kind="car", **more):
    """A vehicle whose middle is so far along a line of places at each step; heads where it goes."""
    steps = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    place, ahead = (
        [np.interp(way + further, steps, path[:, axis]) for axis in (0, 1)]
        for further in (0.0, 0.1)
    )
    heading = np.arctan2(ahead[1] - place[1], ahead[0] - place[0])
    bodies = [
        vehicle(number, {k: (place[0][k], place[1][k])}, kind, heading=heading[k])
        for k in range(len(way))
    ]
    states = {k: body.states[k] for k, body in enumerate(bodies)}
    outlines = {k: body.outlines[k] for k, body in enumerate(bodies)}
    return replace(bodies[0], states=states, outlines=outlines, **more)
