"""Says what is in a file of Waymo's motion data, with the messages that Waymo itself compiled.

Argument: a TFRecord file. Standard output: JSON lines, of each scenario its name, its lights by
state, its kinds of map features, its lanes of more than one point, then for each track its id, its
type and its valid states (step, x, y, heading).
"""

import json
import struct
import sys
from collections import Counter
from pathlib import Path

from waymo_open_dataset.protos import map_pb2, scenario_pb2


def records(data):
    at = 0
    while at < len(data):
        (length,) = struct.unpack_from("<Q", data, at)
        yield data[at + 12 : at + 12 + length]
        at += 16 + length


def main(path):
    say = sys.stdout.write
    for record in records(Path(path).read_bytes()):
        scenario = scenario_pb2.Scenario.FromString(record)
        shown = (lane for state in scenario.dynamic_map_states for lane in state.lane_states)
        name = map_pb2.TrafficSignalLaneState.State.Name
        lights = Counter(name(lane.state) for lane in shown)
        kinds = Counter(one.WhichOneof("feature_data") for one in scenario.map_features)
        ego = scenario.tracks[scenario.sdc_track_index].id
        lanes = [one.id for one in scenario.map_features if len(one.lane.polyline) > 1]
        say(json.dumps(["scenario", scenario.scenario_id, ego, lights, kinds, lanes]) + "\n")
        for track in scenario.tracks:
            states = [
                (step, state.center_x, state.center_y, state.heading)
                for step, state in enumerate(track.states)
                if state.valid
            ]
            kind = scenario_pb2.Track.ObjectType.Name(track.object_type)
            say(json.dumps(["track", str(track.id), kind, states]) + "\n")


main(*sys.argv[1:])
