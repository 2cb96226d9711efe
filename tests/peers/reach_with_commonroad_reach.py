"""What a vehicle can reach, with commonroad-reach alone.

Arguments: CommonRoad's scenarios. Standard output: for each a JSON line, which is null where there
is no road for the first planning problem, else a list with, every half second, the least and the
greatest way and speed along the reference path, and place across it (m, m/s); nobody is in the way.
"""

import json
import sys
import tempfile
from pathlib import Path

from commonroad.common.file_reader import CommonRoadFileReader
from commonroad_reach.data_structure.configuration_builder import ConfigurationBuilder
from commonroad_reach.data_structure.reach.reach_interface import ReachableSetInterface

EVERY, STEPS = 5, 30


def reach(file, folder):
    """The bounds at every fifth of the steps of 0.1 s."""
    scenario, problems = CommonRoadFileReader(str(file)).open()
    config = ConfigurationBuilder(path_root=folder).build_configuration(file.stem)
    config.reachable_set.consider_traffic = False
    config.reachable_set.steps_computation = STEPS
    config.reachable_set.prune_nodes_not_reaching_final_step = False
    config.vehicle.ego.v_lon_min = 0.0
    problem = next(iter(problems.planning_problem_dict.values()))
    config.update(scenario=scenario, planning_problem=problem)
    found = ReachableSetInterface(config)
    found.compute_reachable_sets()
    begin = config.planning.p_lon_initial
    rows = []
    for step in range(0, STEPS + 1, EVERY):
        nodes = found.reachable_set_at_step(step)
        rows.append(
            [
                min(node.p_lon_min for node in nodes) - begin,
                max(node.p_lon_max for node in nodes) - begin,
                min(node.polygon_lon.v_min for node in nodes),
                max(node.polygon_lon.v_max for node in nodes),
                min(node.p_lat_min for node in nodes),
                max(node.p_lat_max for node in nodes),
            ]
        )
    return rows


with tempfile.TemporaryDirectory() as root:
    Path(root, "scenarios").mkdir()
    for name in sys.argv[1:]:
        output = sys.stdout
        sys.stdout = sys.stderr
        try:
            rows = reach(Path(name), root)
        except Exception as error:  # whatever it cannot do is not compared
            sys.stderr.write(f"{name}: {error}\n")
            rows = None
        sys.stdout = output
        sys.stdout.write(json.dumps(rows) + "\n")
