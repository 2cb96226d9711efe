"""A map against what Lanelet2's own library makes of the file."""

import numpy as np
import pytest

from rulec.recordings.lanelet2.map_lanelets import REVERSED


def assert_equal(found, said):
    """Bounds, but for where the origin is, and who is around lanelets on which vehicles drive."""
    own = {name: x for name, x in found.lanelets.items() if not name.endswith(REVERSED)}
    assert own.keys() == said["lanelets"].keys()
    name = next(iter(own))
    offset = own[name].left[0] - said["lanelets"][name]["left"][0]
    driven = {name for name, theirs in said["lanelets"].items() if theirs["passable"]}
    for name, theirs in said["lanelets"].items():
        lanelet = own[name]
        for side in ("left", "right"):
            line = np.array(theirs[side]) + offset
            assert getattr(lanelet, side) == pytest.approx(line, abs=1e-6)
        if name in driven:
            assert sorted(driven.intersection(lanelet.successors)) == theirs["following"]
            for side in ("left_of", "right_of"):
                beside = getattr(lanelet, side)
                assert (beside if beside in driven else None) == theirs[side]
    for name, kmh in said["limits"].items():
        if name in driven:
            assert own[name].limit_mps == pytest.approx(kmh / 3.6)
