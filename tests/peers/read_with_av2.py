"""Says where the boxes of a sensor log are in the city, with Argoverse 2's own API.

Arguments: annotations and poses. Standard output: a JSON line for each annotation, with its track,
its moment (ns), its place (m) and the direction (rad) of its x axis.
"""

import json
import sys

import numpy as np
from av2.geometry.geometry import quat_to_mat
from av2.geometry.se3 import SE3
from pyarrow import feather

QUATERNION = ("qw", "qx", "qy", "qz")
PLACE = ("tx_m", "ty_m", "tz_m")


def pose(row):
    rotation = quat_to_mat(np.array([row[name] for name in QUATERNION]))
    return SE3(rotation, np.array([row[name] for name in PLACE]))


def main(annotations, poses):
    city = {row["timestamp_ns"]: pose(row) for row in feather.read_table(poses).to_pylist()}
    for row in feather.read_table(annotations).to_pylist():
        found = city[row["timestamp_ns"]].compose(pose(row))
        heading = float(np.arctan2(found.rotation[1, 0], found.rotation[0, 0]))
        answer = [row["track_uuid"], row["timestamp_ns"], *found.translation.tolist(), heading]
        sys.stdout.write(json.dumps(answer) + "\n")


main(*sys.argv[1:])
