"""Worlds drawn by hand, and futures in them, for scores."""

from dataclasses import replace

import numpy as np

from rulec.recordings.building import build_lanelet, build_participant, build_recording
from rulec.recordings.recording import Light
from rulec.scoring.traffic_world import TrafficWorld

STEP_S = 0.5


def car(number, speed, x=0.0, y=0.0, count=24, **more):
    """Straight on along the x axis, from time 0."""
    t = STEP_S * np.arange(count)
    return build_participant(number, "car", t, x + speed * t, y + 0 * t, step_s=STEP_S, **more)


def along(places, start):
    """A future through places (x, y), one step apart, from a start: headings and speeds follow."""
    places = np.array(places, dtype=float)
    moved = np.diff(np.vstack((start[:2], places)), axis=0)
    headings = np.where(np.hypot(*moved.T) > 1e-6, np.arctan2(moved[:, 1], moved[:, 0]), 0.0)
    return np.column_stack((places, headings, np.hypot(*moved.T) / STEP_S))


def street(others=(), speed=10.0, past=4, beside=(), **more):
    """Two lanes of a town along the x axis, the right one at y = 0; ego at ``speed`` near x = 0.

    With what the map draws ``beside`` them.
    """
    urban = {"types": ["urban"], "limit_mps": 50 / 3.6, **more}
    lanes = [
        build_lanelet("right", [(-100, 0), (500, 0)], left_of="left", **urban),
        build_lanelet("left", [(-100, 3.5), (500, 3.5)], right_of="right", **urban),
        *beside,
    ]
    return _world(lanes, others, speed, past)


def lit_junction(speed=10.0, past=4, beside=None, colour="red", others=()):
    """A street with a light, always of one ``colour``, at x = 60, and a junction up to x = 80.

    With a lane ``beside`` it, at its left, whose light is always of that colour.
    """
    light, town = Light(0, ((colour, 1000),)), {"types": ["urban"], "limit_mps": 50 / 3.6}
    line = [(60, -1.75), (60, 1.75)]
    lanes = [
        build_lanelet(
            "in",
            [(-100, 0), (60, 0)],
            successors=["across"],
            lights=[light],
            stop_line=line,
            **town,
        ),
        build_lanelet("across", [(60, 0), (80, 0)], successors=["out"], junction="j", **town),
        build_lanelet("out", [(80, 0), (400, 0)], **town),
        build_lanelet("from", [(70, -80), (70, -10)], successors=["over"], **town),
        build_lanelet("over", [(70, -10), (70, 10)], successors=["to"], junction="j", **town),
        build_lanelet("to", [(70, 10), (70, 80)], **town),
    ]
    if beside is not None:
        lanes = [*_with_left(lanes[:3], Light(0, ((beside, 1000),))), *lanes[3:]]
    return _world(lanes, others, speed, past, complete={"light"})


def stop_junction(speed=8.0, past=3):
    """A street with a stop sign at x = 20, and a junction behind it up to x = 40; nobody comes."""
    line, town = [(20, -1.75), (20, 1.75)], {"types": ["urban"], "limit_mps": 50 / 3.6}
    lanes = [
        build_lanelet(
            "in",
            [(-100, 0), (20, 0)],
            successors=["across"],
            signs=["STOP"],
            stop_line=line,
            **town,
        ),
        build_lanelet("across", [(20, 0), (40, 0)], successors=["out"], junction="j", **town),
        build_lanelet("out", [(40, 0), (400, 0)], **town),
        build_lanelet("from", [(30, -80), (30, -10)], successors=["over"], **town),
        build_lanelet("over", [(30, -10), (30, 10)], successors=["to"], junction="j", **town),
        build_lanelet("to", [(30, 10), (30, 80)], **town),
    ]
    return _world(lanes, (), speed, past, complete={"STOP"})


def _with_left(lanes, light):
    """Lanes along the x axis with others at their left, 3.5 m wide, which lead to each other."""
    aside = np.array([0.0, 3.5])
    for lane in lanes:
        yield replace(lane, left_of=f"{lane.id} left")
        yield replace(
            lane,
            id=f"{lane.id} left",
            left=lane.left + aside,
            right=lane.left,
            centre=lane.centre + aside,
            right_of=lane.id,
            successors=tuple(f"{one} left" for one in lane.successors),
            lights=(light,) if lane.lights else (),
            stop_line=None if lane.stop_line is None else lane.stop_line + aside,
        )


def _world(lanes, others, speed, past, **more):
    ego = car("ego", speed, x=-speed * STEP_S * (past - 1), count=past)
    found = build_recording(lanes, [*others, ego], step_s=STEP_S, side="right", **more)
    return TrafficWorld(found, "ego")
