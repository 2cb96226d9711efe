"""Slow participants of unknown type: what would differ if they were vehicles is unknown."""

import numpy as np
import pytest

import rulec

T = np.arange(0, 20.05, 0.1)
KINDS = {"width": 3.6, "limit_mps": 36.0, "types": ("interstate", "mainCarriageWay")}


def passing(kind):
    """Ego drives on the far one of two lanes, past a column on the near one."""
    near = rulec.build_lanelet("near", [(0, 0), (1200, 0)], left_of="far", **KINDS)
    far = rulec.build_lanelet("far", [(0, 3.6), (1200, 3.6)], right_of="near", **KINDS)
    column = [(f"c{k}", kind, 170.0 + 32 * k, 11.0, 0.0) for k in range(8 if kind else 0)]
    known = [("a", "car", 200.0, 15.0, 3.6), ("z", "car", 60.0, 15.0, 3.6)]
    bodies = [
        rulec.build_participant(name, own, T, x + mps * T, y + 0 * T, step_s=0.1)
        for name, own, x, mps, y in (*known, ("y", "car", 20.0, 11.0, 0.0), *column)
    ]
    return rulec.build_recording([near, far], bodies, step_s=0.1, side="right")


def verdict(kind):
    wanted = rulec.RequestedDrives(egos=("a",))
    (drive,) = rulec.verify_recording(passing(kind), rulec.compile_rulebook("de"), wanted=wanted)
    if "keep_near_side" in {violation.rule for violation in drive.answer.violations}:
        return "violated"
    return "open" if "keep_near_side" in {part.rule for part in drive.answer.open} else "kept"


@pytest.mark.parametrize(
    ("kind", "found"), [("car", "kept"), ("unknown", "open"), (None, "violated")]
)
def test_a_lane_on_which_somebody_unknown_drives_may_not_be_free(kind, found):
    assert verdict(kind) == found
