"""Making a scenario along ego's road from a recording.

The signals' names are those of the vocabulary ``road``. A signal that the file does not provide is
missing, and the rulebook's default applies. One signal is derived, since no file states congestion:
traffic is congested where the median speed of the vehicles on ego's road in ego's direction is
below a threshold. These speeds are measured along the road from time 0 on, for a second if the
recording is that long, because the speed written in some recordings differs.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from statistics import median

import numpy as np

from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.mending.mended_recording import mended
from rulec.recordings.recording import Lanelet, Recording, TrackState
from rulec.scenario.geometry import Box
from rulec.scenario.motion import swept
from rulec.scenario.recorded import ego_start as starts
from rulec.scenario.recorded.ego_start import choice_error, ego_start, reference_lanelet
from rulec.scenario.recorded.lane_coordinates import borders_along, crossings_along, lanes_along
from rulec.scenario.recorded.reference_line import ReferenceLine, leading_on, reference_line
from rulec.scenario.recorded.route import REACH_M, lanelets_at, lanes_beside, route
from rulec.scenario.recorded.scene_origin import SceneOrigin
from rulec.scenario.recorded.traffic_obstacles import TrafficView, traffic_obstacles
from rulec.scenario.scenario_model import (
    USUAL_HORIZON_S,
    Account,
    Choice,
    Ego,
    MissingLane,
    Obstacle,
    Road,
    Scenario,
    SceneSource,
    SignalValue,
    Stretch,
)
from rulec.scenario.time_grid import whole_steps

STEP_S = 0.5

FEWEST = 3
"""The fewest vehicles that can make traffic congested."""

_STEPS_S = STEP_S, STEP_S / 2, STEP_S / 4, STEP_S / 8
"""The steps (s) from which a horizon shorter than the usual step takes the longest that fits."""

_FOR_S = 1.0
_MORE_M = 5.0

LIGHT_FOR_S = 10.0
"""Ego's light counts if all its traffic lights show one colour for this long (s) from time 0 on."""

LANELETS_TO_A_LIGHT = 2
"""Ego's light is that of its own lanelet, or else of the next one."""

_SIGNS = {
    "YIELD": "give_way_sign",
    "STOP": "stop_sign",
    "NO_OVERTAKING_START": "no_overtaking_sign",
}
_COLOURS = {"red": "red_light", "yellow": "amber_light", "green": "green_light"}
_MOTORWAYS = {"highway", "interstate"}
_COUNTS = {1: "one_lane", 2: "two_lanes"}


def seen_from_ego(recording: Recording, choice: Choice, file: str) -> Scenario:
    """The scenario of a recording, seen from the chosen ego.

    Raises RulecError R0612 if what is chosen is not in it, ValueError if its lanes cannot be laid
    out along a line.
    """
    source = SceneSource(recording, choice, file)
    recording = mended(recording)
    start = ego_start(recording, choice, file)
    own = reference_lanelet(recording, choice, start.state, file)
    way = route(recording, own, lanelets_at(recording, start.targets))
    centres = [recording.lanelets[name].centre for name in way]
    line = reference_line(leading_on(np.concatenate(centres)))
    ego_s, ego_d = _place_on(own, start.state, [recording.lanelets[n] for n in way], line)
    if not 0 <= ego_s <= line.length:
        message = f"ego is not beside lanelet {own}, nor the road before and after it"
        raise choice_error(
            message, "choose with --reference a lanelet of the road that ego is on", file
        )
    lanes = lanes_along(recording, way, line, ego_s)
    ((d,),) = lanes.straightened(np.array([[ego_s, ego_d]])).tolist()
    if not lanes.straight[0] <= d <= lanes.straight[-1]:
        message = f"ego is off the road of lanelet {own}, {abs(ego_d):.1f} m from its middle"
        raise choice_error(
            message, "choose another ego with --ego, or lanelet with --reference", file
        )
    low, high = max(0.0, ego_s - REACH_M), min(line.length, ego_s + REACH_M)
    bounds = tuple(lanes.straight.tolist())
    crossings = crossings_along(recording, line, lanes, low, high)
    stretches = tuple(Stretch("crossing", (s0 - ego_s, s1 - ego_s)) for s0, s1 in crossings)
    missing = tuple([MissingLane(*own) for own in lanes.missing(low, high, ego_s)])
    road = Road((low - ego_s, high - ego_s), bounds, stretches, missing)
    at_s = start.step * recording.step_s
    motion = starts.ego_motion(recording, start, line.heading_at(ego_s), own, file)
    view = TrafficView(
        recording=recording,
        line=line,
        lanes=lanes,
        ego_s=ego_s,
        at_s=at_s,
        road=road.outline,
        ego_d=d,
        ego_speed=motion["speed"] or 0.0,
    )
    on_road = tuple(traffic_obstacles(view, start.participant, choice.prediction))
    congestion = congested(on_road, road.outline, choice.congested_below_kmh)
    count = int(lanes.existing_at(np.array(ego_s)).sum())
    ahead = [recording.lanelets[number] for number in way[way.index(own) :]]
    derived = {
        # The paper's name, and that of the vocabulary `road`
        "CONGESTED": congestion,
        "congested": congestion,
        **map_signals(ahead, count, recording.step_s, start.step),
    }
    ends_s = _map_ends_s(recording, way[-1], road.outline.s_max, motion["speed"])
    horizon_s, step_s, remarks = USUAL_HORIZON_S, STEP_S, recording.remarks
    map_ends = ends_s is not None and ends_s < USUAL_HORIZON_S
    if ends_s is not None and map_ends:
        # Beyond the map's end ego would have to stop for no reason
        step_s = next((step for step in _STEPS_S if step <= ends_s), _STEPS_S[-1])
        horizon_s = whole_steps(ends_s, step_s)
        away = f"{road.outline.s_max:.1f} m ahead of ego, which gets there in {ends_s:.1f} s"
        remarks = (
            *remarks,
            f"the map ends {away}: the horizon ends there, unless --horizon is given",
        )
    others = sum(participant.id != start.participant for participant in recording.participants)
    return Scenario(
        recording.name,
        road,
        Ego(
            0.0,
            d,
            *starts.ego_size(recording, start, choice),
            **motion,
        ),
        on_road,
        {name: value for name, (value, _) in derived.items()},
        horizon_s=horizon_s,
        step_s=step_s,
        about=f"{recording.form} {recording.name}",
        account=Account(
            reference=own,
            recorded=others,
            left_out=others - len(on_road),
            until_s=view.until_s,
            derived={name: how for name, (_, how) in derived.items()},
            remarks=remarks,
            map_ends=map_ends,
            source=source,
            origin=SceneOrigin(recording, start, line, lanes, ego_s=ego_s, way=tuple(way))
            if choice.prediction == "recorded"
            else None,
        ),
    )


def _map_ends_s(
    recording: Recording, last: str, away_m: float, speed_mps: float | None
) -> float | None:
    """The time (s) at which ego reaches the end of the map; None if the map does not end there.

    The map ends where neither the last lanelet of ego's road nor a lane beside it has a successor;
    if a lane beside it has one, only ego's lane ends. None also if ego has no speed.
    """
    left, right = (lanes_beside(recording, last, left=left) for left in (True, False))
    leads_on = any(recording.lanelets[name].successors for name in (last, *left, *right))
    return None if leads_on or not speed_mps else away_m / speed_mps


def _place_on(
    own: str, state: TrackState, way: Sequence[Lanelet], line: ReferenceLine
) -> tuple[float, float]:
    """The coordinates of ego on lanelet ``own``; the route may pass the same place twice."""
    borders = borders_along(way, line)
    number = next(k for k, lanelet in enumerate(way) if lanelet.id == own)
    middle, reach = (borders[number + 1] + borders[number]) / 2, np.diff(borders)[number] / 2
    place = np.array([[state.x, state.y]])
    ((s, d),) = line.coordinates_near(
        place, np.array([middle]), np.array([reach + _MORE_M])
    ).tolist()
    return s, d


def map_signals(
    ahead: Sequence[Lanelet], lanes: int, step_s: float, step: int
) -> dict[str, tuple[SignalValue, str]]:
    """Signal -> its value, and a text that says where the value comes from.

    ``ahead`` are the lanelets of ego's road from its own on, ``lanes`` is the number of lanes side
    by side at ego's place, ``step`` the time step of time 0.
    """
    own = ahead[0]
    signals: dict[str, tuple[SignalValue, str]] = {}
    here = f"lanelet {own.id}"
    if own.limit_mps is not None:
        signals["limit"] = round(own.limit_mps * KMH_PER_MPS, 2), f"the limit of {here}"
    for sign, signal in _SIGNS.items():
        if sign in own.signs:
            signals[signal] = True, f"the sign of {here}"
    if own.types & _MOTORWAYS:
        signals["road_class"] = "motorway", f"the type of {here}"
    count = _COUNTS.get(lanes, "three_or_more_lanes")
    signals["lanes"] = count, f"{lanes} at ego's place that lead its way"
    lit = next((lanelet for lanelet in ahead[:LANELETS_TO_A_LIGHT] if lanelet.lights), None)
    if lit is not None:
        steps = range(step, step + round(LIGHT_FOR_S / step_s) + 1)
        shown = {light.colour_at(k) for light in lit.lights for k in steps}
        if len(shown) == 1 and (colour := shown.pop()) in _COLOURS:
            signals["light"] = _COLOURS[colour], f"the traffic lights of lanelet {lit.id}"
    return signals


def congested(obstacles: Iterable[Obstacle], road: Box, below_kmh: float) -> tuple[bool, str]:
    """Whether traffic is congested, and the reason as text."""
    speeds = [
        speed * KMH_PER_MPS
        for obstacle in obstacles
        if "vehicle" in (obstacle.type, *obstacle.broader)
        and (speed := _speed(obstacle, road)) is not None
    ]
    if len(speeds) < FEWEST:
        few = f"it takes {FEWEST} vehicles that go ego's way on its road, here {len(speeds)}"
        return False, few
    middle = median(speeds)
    relation = "below" if middle < below_kmh else "not below"
    compared = f"{middle:.1f} km/h, {relation} {float(below_kmh):g} km/h"
    return middle < below_kmh, f"the median speed of {len(speeds)} vehicles is {compared}"


def _speed(obstacle: Obstacle, road: Box) -> float | None:
    """The speed along the road (m/s); None off the road, and for oncoming traffic."""
    now = swept(obstacle, 0.0, 0.0)
    then = swept(obstacle, _FOR_S, _FOR_S)
    if now is None or then is None or not now.overlaps(road):
        return None
    speed = now.shift_to(then)[0] / _FOR_S
    # Inexact recordings let standing vehicles drift backwards
    return max(speed, 0.0) if speed > -1.0 else None
