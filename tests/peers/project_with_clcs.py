"""Turns places into coordinates along a line, with commonroad-clcs alone.

Standard input: JSON lines {"line": [[x, y], …], "places": [[x, y], …]}; standard output: for each a
JSON list of [s, d], or null for a place outside the domain of the projection.
"""

import json
import sys

import numpy as np
from commonroad_clcs.clcs import CurvilinearCoordinateSystem
from commonroad_clcs.config import CLCSParams
from commonroad_clcs.pycrccosy import CartesianProjectionDomainError


def project(frame, x, y):
    """The coordinates of a place; None outside the domain."""
    try:
        return frame.convert_to_curvilinear_coords(x, y).tolist()
    except CartesianProjectionDomainError:
        return None


for line in sys.stdin:
    job = json.loads(line)
    frame = CurvilinearCoordinateSystem(np.array(job["line"]), CLCSParams(), preprocess_path=False)
    found = [project(frame, x, y) for x, y in job["places"]]
    sys.stdout.write(json.dumps(found) + "\n")
