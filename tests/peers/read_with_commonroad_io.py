"""Says what CommonRoad files hold, with commonroad-io alone.

Arguments: files. Standard output: for each a JSON line, in the library's own words.
"""

import io
import json
import re
import sys
import warnings
from contextlib import redirect_stderr, redirect_stdout
from xml.etree import ElementTree

import numpy as np
import shapely
from commonroad.common.file_reader import CommonRoadFileReader
from commonroad.common.util import Interval
from commonroad.geometry.occupancy.circle_occupancy import CircleOccupancy

LAMPS = (
    "indicator_left",
    "indicator_right",
    "hazard_warning_lights",
    "braking_lights",
    "flashing_blue_lights",
    "horn",
)


def read(path):
    """What the library has read of a file, as lists and dictionaries."""
    if path.endswith(".pb"):
        scenario, problems, environment = read_parts(path)
        drawn = {str(one.lanelet_id) for one in scenario.lanelet_network.lanelets}
    else:
        scenario, problems = CommonRoadFileReader(path).open()
        environment = scenario.environment
        # The library puts a stop line without a place at the end of its lanelet
        nodes = ElementTree.parse(path).getroot().findall("lanelet")
        drawn = {node.get("id") for node in nodes if node.find("stopLine/point") is not None}
    network = scenario.lanelet_network
    return {
        "step_s": scenario.dt,
        "lanelets": [lanelet(one, str(one.lanelet_id) in drawn) for one in network.lanelets],
        "signs": {
            sign.traffic_sign_id: [
                [element.traffic_sign_element_id.name, element.additional_values]
                for element in sign.traffic_sign_elements
            ]
            for sign in network.traffic_signs
        },
        "lights": {light.traffic_light_id: programme(light) for light in network.traffic_lights},
        "intersections": {one.intersection_id: starts(one) for one in network.intersections},
        "weather": getattr(environment and environment.weather, "value", None),
        "underground": getattr(environment and environment.underground, "value", None),
        "participants": list(participants(scenario)),
        "problems": [problem(one) for one in problems.planning_problem_dict.values()],
    }


def read_parts(dynamic):
    """A scenario in Protocol Buffers, of which the part with the traffic is given."""
    stem = dynamic.removesuffix(".pb")
    road = re.sub(r"_\d+_[A-Z]-\d+$", "", stem)
    files = {"filename_map": f"{road}.pb", "filename_scenario": f"{stem}-SC.pb"}
    reader = CommonRoadFileReader(filename_dynamic=dynamic, **files)
    scenario, problems, _ = reader.open_all()
    # It leaves the environment out of the scenario
    return scenario, problems, reader.open_dynamic().environment


def lanelet(one, has_drawn_stop_line):
    line = one.stop_line if has_drawn_stop_line else None
    return {
        "id": one.lanelet_id,
        "left": places(one.left_vertices),
        "right": places(one.right_vertices),
        "centre": places(one.center_vertices),
        "successors": one.successor,
        "predecessors": one.predecessor,
        "left_of": one.adj_left if one.adj_left_same_direction else None,
        "right_of": one.adj_right if one.adj_right_same_direction else None,
        "types": sorted(kind.value for kind in one.lanelet_type),
        "left_mark": one.line_marking_left_vertices.value,
        "right_mark": one.line_marking_right_vertices.value,
        "signs": sorted(one.traffic_signs),
        "lights": sorted(one.traffic_lights),
        "stop_line": line and places([line.start, line.end]),
    }


def programme(light):
    """The offset and the phases of a light; None if it does not work."""
    cycle = light.traffic_light_cycle
    phases = [[phase.state.value, phase.duration] for phase in cycle.cycle_elements]
    return [cycle.time_offset, phases] if light.active else None


def starts(intersection):
    """The lanelets that ways through an intersection begin with."""
    ways = set()
    for incoming in intersection.incomings:
        ways |= incoming.outgoing_right | incoming.outgoing_straight | incoming.outgoing_left
    return sorted(ways)


def participants(scenario):
    for one in scenario.static_obstacles:
        yield participant(one, [one.initial_state], standing=True)
    for one in scenario.dynamic_obstacles:
        trajectory = getattr(one.prediction, "trajectory", None)
        states = [one.initial_state, *(trajectory.state_list if trajectory else ())]
        yield participant(one, states, standing=False)
    for one in scenario.environment_obstacle:
        outlines = [[0, corners(one.occupancy_at_time(0))]]
        yield described(one, one.obstacle_type.value, True, [], outlines)
    for one in scenario.phantom_obstacle:
        yield described(one, "unknown", False, [], list(occupied(one.prediction)))


def participant(one, states, standing):
    steps = [state.time_step for state in states]
    outlines = [[step, corners(one.occupancy_at_time(step))] for step in steps]
    if not standing and not hasattr(one.prediction, "trajectory"):
        outlines += occupied(one.prediction)
    known = [
        {
            "step": state.time_step,
            "place": place(state, outline),
            "heading": middle(state.orientation),
            "speed": middle(getattr(state, "velocity", 0.0)),
            "acceleration": middle(getattr(state, "acceleration", 0.0)),
        }
        for state, (_, outline) in zip(states, outlines, strict=False)
    ]
    series = [one.initial_signal_state, *(one.signal_series or ())]
    lamps = [
        [state.time_step, {lamp: getattr(state, lamp) for lamp in LAMPS if hasattr(state, lamp)}]
        for state in series
        if state is not None
    ]
    return described(one, one.obstacle_type.value, standing, known, outlines, lamps)


def described(one, kind, standing, states, outlines, lamps=None):
    return {
        "id": one.obstacle_id,
        "type": kind,
        "standing": standing,
        "states": states,
        "outlines": outlines,
        "lamps": lamps,
    }


def occupied(prediction):
    """Step and corners of all that a set-based prediction occupies."""
    for time, occupancy in prediction.occupancies.items() if prediction else ():
        steps = range(time.start, time.end + 1) if isinstance(time, Interval) else [time]
        for step in steps:
            yield [step, corners(occupancy)]


def corners(occupancy):
    """The corners of an area, or of what is around several."""
    if isinstance(occupancy, CircleOccupancy):
        # Its own polygon has half the radius, unlike what it draws and says to contain a point
        return places(occupancy.circle_center.buffer(occupancy.radius).exterior.coords[:-1])
    shape = occupancy.shapely_object
    around = shape if shape.geom_type == "Polygon" else shape.convex_hull
    return places(around.exterior.coords[:-1])


def place(state, outline):
    """Where a state is; of an area the mean of what is occupied."""
    if isinstance(state.position, np.ndarray):
        return places([state.position])[0]
    return np.mean(outline, axis=0).tolist()


def middle(value):
    return (value.start + value.end) / 2 if isinstance(value, Interval) else value


def problem(one):
    start = one.initial_state
    goals = []
    for state in one.goal.state_list:
        position = getattr(state, "position", None)
        if isinstance(position, np.ndarray):
            goals.append(places([position])[0])
        elif position is not None:
            goals.append(list(shapely.centroid(position.shapely_object).coords[0]))
    lanelets = (one.goal.lanelets_of_goal_position or {}).values()
    return {
        "id": one.planning_problem_id,
        "step": start.time_step,
        "place": places([start.position])[0],
        "heading": start.orientation,
        "speed": start.velocity,
        "acceleration": start.acceleration,
        "goals": goals,
        "goal_lanelets": [number for numbers in lanelets for number in numbers],
    }


def places(vertices):
    return [[float(x), float(y)] for x, y, *_ in vertices]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    for path in sys.argv[1:]:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            found = read(path)
        sys.stdout.write(json.dumps(found) + "\n")
