"""From a recording to a scenario along ego's road."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rulec.scenario.recorded.congestion import congested
from rulec.scenario.recorded.crosswalks import road_crossings
from rulec.scenario.recorded.ego_start import choice_error, ego_size, ego_start, reference_lanelet
from rulec.scenario.recorded.lane_coordinates import lanes_along
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.recorded.reference_line import reference_line
from rulec.scenario.recorded.route import REACH_M, lanelets_at, route
from rulec.scenario.recorded.scene_choice import Choice
from rulec.scenario.recorded.scene_signals import map_signals
from rulec.scenario.recorded.traffic_obstacles import TrafficView, traffic_obstacles
from rulec.scenario.scenario_model import Account, Ego, Obstacle, Road, Scenario, SignalValue

STEP_S = 0.5


def to_scenario(recording: Recording, choice: Choice, file: str) -> Scenario:
    """The scenario that a recording gives, seen from the chosen ego.

    Raises:
        RulecError: R0612 if what is chosen is not in it.
        ValueError: its lanes cannot be laid out along a line.
    """
    start = ego_start(recording, choice, file)
    own = reference_lanelet(recording, choice, start.state, file)
    way = route(recording, own, lanelets_at(recording, start.targets))
    line = reference_line(np.concatenate([recording.lanelets[n].centre for n in way]))
    ((ego_s, ego_d),) = line.coordinates(np.array([[start.state.x, start.state.y]])).tolist()
    if not 0 <= ego_s <= line.length:
        message = f"ego is not beside lanelet {own}, nor the road before and after it"
        raise choice_error(
            message, "choose with --reference a lanelet of the road that ego is on", file
        )
    lanes = lanes_along(recording, way, line, ego_s)
    ((_, d),) = lanes.straightened(np.array([[ego_s, ego_d]])).tolist()
    if not lanes.straight[0] <= d <= lanes.straight[-1]:
        message = f"ego is beside the road of lanelet {own}, {abs(ego_d):.1f} m from its middle"
        raise choice_error(
            message, "choose another ego with --ego, or lanelet with --reference", file
        )
    low, high = max(0.0, ego_s - REACH_M), min(line.length, ego_s + REACH_M)
    bounds = tuple(lanes.straight.tolist())
    road = Road((low - ego_s, high - ego_s), bounds, (), lanes.missing(low, high, ego_s))
    at_s = start.step * recording.step_s
    view = TrafficView(
        recording=recording, line=line, lanes=lanes, ego_s=ego_s, at_s=at_s, road=road.outline
    )
    on_road = tuple(traffic_obstacles(view, start.participant, choice.prediction))
    derived = {
        **_traffic_signals(view, on_road, choice),
        **_map_signals(view, way, own, start.step),
    }
    others = sum(participant.id != start.participant for participant in recording.participants)
    return Scenario(
        recording.name,
        replace(road, surfaces=road_crossings(view)),
        Ego(0.0, d, *ego_size(recording, start, choice)),
        on_road,
        {name: value for name, (value, _) in derived.items()},
        step_s=STEP_S,
        about=f"{recording.form} {recording.name}",
        account=Account(
            reference=own,
            recorded=others,
            left_out=others - len(on_road),
            until_s=view.until_s,
            derived={name: how for name, (_, how) in derived.items()},
            remarks=recording.remarks,
        ),
    )


def _traffic_signals(
    view: TrafficView, on_road: Sequence[Obstacle], choice: Choice
) -> dict[str, tuple[SignalValue, str]]:
    # The paper's word and that of the vocabulary `road`
    derived = congested(on_road, view.road, choice.congested_below_kmh)
    return {"CONGESTED": derived, "congested": derived}


def _map_signals(
    view: TrafficView, way: Sequence[str], own: str, step: int
) -> dict[str, tuple[SignalValue, str]]:
    ahead = [view.recording.lanelets[number] for number in way[way.index(own) :]]
    return map_signals(ahead, view.lanes.count_at(view.ego_s), view.recording.step_s, step)
