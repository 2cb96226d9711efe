"""Scenes of roads and traffic in which it is known, by construction, how ego may drive."""

import random
from dataclasses import dataclass

import numpy as np

from rulec import Choice, load_scenario
from rulec.recordings.building import build_lanelet, build_participant, build_recording

STEP_S, STATES = 0.1, 71
_T = STEP_S * np.arange(STATES)
_WIDTH_M, _LENGTH_M, _HORIZON_S = 3.5, 4.5, 4.0


@dataclass(frozen=True)
class BuiltScene:
    """A scene in the form of a recording, and what a driver does in it.

    ``goes_on``: nobody is in the way at ego's speed. ``least``: the braking (m/s²) with which ego
    keeps behind everybody, where somebody is.
    """

    name: str
    scenario: object
    goes_on: bool
    least: float = 0.0


KINDS = ("beside", "ahead", "in a curve", "at a junction")


def built(kind, chance: random.Random):
    """A scene of one of the ``KINDS``."""
    return {
        "beside": _beside,
        "ahead": _ahead,
        "in a curve": _in_a_curve,
        "at a junction": _at_a_junction,
    }[kind](chance)


def _beside(chance):
    """Two or three lanes; ego's has nobody, the others have vehicles of any speed."""
    count = chance.randint(2, 3)
    own, speed = chance.randrange(count), chance.uniform(8.0, 30.0)
    others = [lane for lane in range(count) if lane != own]
    cars = []
    for lane in others:
        x = chance.uniform(-70.0, 0.0)
        for _ in range(chance.randint(1, 5)):
            cars.append((x, max(3.0, speed + chance.uniform(-6.0, 6.0)), lane))
            x += chance.uniform(6.0, 60.0)
    return _on_lanes("beside", count, own, speed, cars, goes_on=True)


def _ahead(chance):
    """One in ego's lane is slower, so near that ego has to brake gently, and a lane is beside."""
    speed, slower = chance.uniform(10.0, 28.0), chance.uniform(2.0, 9.0)
    least = chance.uniform(0.5, 2.5)
    gap = max(slower**2 / 2 / least, 6.0)
    least = slower**2 / 2 / gap
    side = [(chance.uniform(-40.0, 60.0), speed + chance.uniform(-4.0, 4.0), 1)]
    cars = [(gap + _LENGTH_M, speed - slower, 0), *side]
    return _on_lanes("ahead", 2, 0, speed, cars, goes_on=False, least=least)


def _on_lanes(name, count, own, speed, cars, *, goes_on, least=0.0):
    about = {"types": ["highway"], "limit_mps": 36.0}
    lanes = [
        build_lanelet(
            f"lane {k}",
            [(-400.0, _WIDTH_M * k), (900.0, _WIDTH_M * k)],
            width=_WIDTH_M,
            left_of=f"lane {k + 1}" if k + 1 < count else None,
            right_of=f"lane {k - 1}" if k else None,
            **about,
        )
        for k in range(count)
    ]
    bodies = [
        build_participant(f"o{k}", "car", _T, x + v * _T, 0 * _T + _WIDTH_M * lane, step_s=STEP_S)
        for k, (x, v, lane) in enumerate(cars)
    ]
    ego = (speed * _T, 0 * _T + _WIDTH_M * own)
    return _scene(name, lanes, ego, bodies, goes_on=goes_on, least=least)


def _in_a_curve(chance):
    """A road of one radius, taken at 2 m/s² at most, with one ahead of it that is as fast."""
    radius = chance.uniform(60.0, 300.0)
    speed = min(chance.uniform(6.0, 20.0), np.sqrt(2.0 * radius))
    side = chance.choice([-1.0, 1.0])

    def places(way):
        """Straight before 0, and round from there on."""
        angle = np.maximum(way, 0.0) / radius
        x = np.minimum(way, 0.0) + radius * np.sin(angle)
        return x, side * radius * (1.0 - np.cos(angle)), side * angle

    turned = min(250.0, 2.5 * radius)
    x, y, _ = places(np.arange(-150.0, turned, 2.0))
    about = {"types": ["urban"], "limit_mps": 25.0}
    lanes = [build_lanelet("road", list(zip(x, y, strict=True)), width=_WIDTH_M, **about)]
    begin = chance.uniform(-60.0, 0.0)
    far = chance.uniform(2.5 * speed, 4.0 * speed)
    bodies = []
    if begin + far + speed * _T[-1] < turned - 10.0:
        bodies = [_along(places, "ahead", begin + far + speed * _T)]
    x, y, heading = places(begin + speed * _T)
    return _scene("in a curve", lanes, (x, y), bodies, goes_on=True, heading=heading)


def _along(places, name, way):
    x, y, heading = places(way)
    return build_participant(name, "car", _T, x, y, heading=heading, step_s=STEP_S)


def _at_a_junction(chance):
    """Somebody crosses ego's way: two seconds before ego comes or after it has gone, or then."""
    speed, at = chance.uniform(7.0, 14.0), chance.uniform(25.0, 40.0)
    across = chance.uniform(6.0, 14.0)
    side = chance.choice([-1.0, 1.0])
    meets = chance.random() < 0.4
    comes = at / speed
    when = comes if meets else comes + chance.choice([-2.5, 2.5])
    town = {"types": ["urban"], "limit_mps": 50 / 3.6, "width": _WIDTH_M}
    lanes = [
        build_lanelet("in", [(-200, 0), (at - 10, 0)], successors=["over"], **town),
        build_lanelet(
            "over", [(at - 10, 0), (at + 10, 0)], successors=["out"], junction="j", **town
        ),
        build_lanelet("out", [(at + 10, 0), (400, 0)], **town),
        build_lanelet("from", [(at, -200 * side), (at, -10 * side)], successors=["across"], **town),
        build_lanelet(
            "across", [(at, -10 * side), (at, 10 * side)], successors=["to"], junction="j", **town
        ),
        build_lanelet("to", [(at, 10 * side), (at, 200 * side)], **town),
    ]
    y = side * across * (_T - when)
    crossing = build_participant("crosses", "car", _T, 0 * _T + at, y, step_s=STEP_S)
    # Who stops 3 m before it needs no more than this
    least = speed**2 / 2 / (at - 8.0) if meets else 0.0
    ego = (speed * _T, 0 * _T)
    return _scene("at a junction", lanes, ego, [crossing], goes_on=not meets, least=least)


def _scene(name, lanes, ego, bodies, *, goes_on, least=0.0, heading=None):
    x, y = ego
    own = build_participant("ego", "car", _T, x, y, heading=heading, step_s=STEP_S)
    recording = build_recording(lanes, [own, *bodies], step_s=STEP_S, side="right")
    scenario = load_scenario(recording, Choice(ego="ego", at_s=0.0))
    return BuiltScene(name, scenario, goes_on, least)
