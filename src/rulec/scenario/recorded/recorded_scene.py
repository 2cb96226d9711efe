"""From a recording to a scenario along ego's road."""

from __future__ import annotations

import numpy as np

from rulec.scenario.recorded.ego_start import choice_error, ego_size, ego_start, reference_lanelet
from rulec.scenario.recorded.lane_coordinates import crossings_along, lanes_along
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.recorded.reference_line import reference_line
from rulec.scenario.recorded.route import REACH_M, lanelets_at, route
from rulec.scenario.recorded.scene_signals import congested, map_signals
from rulec.scenario.recorded.traffic_obstacles import TrafficView, traffic_obstacles
from rulec.scenario.scenario_model import Account, Choice, Ego, Road, Scenario, Stretch

STEP_S = 0.5


def seen_from_ego(recording: Recording, choice: Choice, file: str) -> Scenario:
    """The scenario that a recording gives, seen from the chosen ego.

    Raises RulecError R0612 if what is chosen is not in it, ValueError if its lanes cannot be laid
    out along a line.
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
    crossings = crossings_along(recording, line, lanes, low, high)
    stretches = tuple(Stretch("crossing", (s0 - ego_s, s1 - ego_s)) for s0, s1 in crossings)
    road = Road((low - ego_s, high - ego_s), bounds, stretches, lanes.missing(low, high, ego_s))
    at_s = start.step * recording.step_s
    view = TrafficView(
        recording=recording, line=line, lanes=lanes, ego_s=ego_s, at_s=at_s, road=road.outline
    )
    on_road = tuple(traffic_obstacles(view, start.participant, choice.prediction))
    congestion = congested(on_road, road.outline, choice.congested_below_kmh)
    count = int(lanes.existing_at(np.array(ego_s)).sum())
    ahead = [recording.lanelets[number] for number in way[way.index(own) :]]
    derived = {
        # The paper's word and that of the vocabulary `road`
        "CONGESTED": congestion,
        "congested": congestion,
        **map_signals(ahead, count, recording.step_s, start.step),
    }
    others = sum(participant.id != start.participant for participant in recording.participants)
    return Scenario(
        recording.name,
        road,
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
