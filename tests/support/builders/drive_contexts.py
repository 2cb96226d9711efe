"""The context of one drive, made by the passes before the signals, for tests of a single signal."""

from dataclasses import replace

import numpy as np

from rulec.extraction.drive_context import drive_context
from rulec.extraction.tracks.driven_road import driven_road
from rulec.extraction.tracks.junction_lanelets import junction_lanelets
from rulec.extraction.tracks.relevance import relevant_participants
from rulec.extraction.tracks.road_extents import road_extents
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.tracks.vulnerable_user_surface import on_crosswalks, on_lanes
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.recordings import vehicle

EGO = "7"


def context_of(found, route=("1",), side="right", ego=EGO, **thresholds):
    """The context of ego's drive along a chain of lanelets, while ego is in the recording."""
    limits = replace(USUAL, **thresholds)
    tracks = tracks_of(found, limits)
    road = driven_road(found, route, junction_lanelets(found))
    extents = road_extents(tracks, road)
    row = [body.id for body in tracks.participants].index(ego)
    columns = np.flatnonzero(tracks.present[row])
    return drive_context(
        recording=found,
        thresholds=limits,
        side=side,
        road=road,
        tracks=tracks,
        extents=extents,
        relevant=relevant_participants(row, tracks, extents, road, limits),
        on_lane=on_lanes(found, tracks),
        on_crosswalk=on_crosswalks(found, tracks),
        ego=row,
        columns=(int(columns[0]), int(columns[-1])),
    )


def steady(number, x, y, speed=10.0, steps=4, first=0, step_s=0.5, **more):
    """Places of a participant at constant speed along the x axis, for ``vehicle``."""
    heading = more.pop("heading", 0.0 if speed >= 0 else float(np.pi))
    places = {first + k: (x + speed * step_s * k, y) for k in range(steps)}
    return vehicle(number, places, speed=abs(speed), heading=heading, **more)
