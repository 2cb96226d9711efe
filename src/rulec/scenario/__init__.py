"""Scenarios: the road, ego, the obstacles with their predictions, and reading scenarios from files.

Names are imported on first use, because a recorded drive needs only few of them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rulec.scenario.geometry import Box
    from rulec.scenario.motion_bounds import MotionBounds
    from rulec.scenario.scenario_files import available_scenarios, load_scenario
    from rulec.scenario.scenario_model import (
        Account,
        Alternative,
        Choice,
        ConstantAcceleration,
        Ego,
        Footprints,
        MissingLane,
        Obstacle,
        Road,
        Scenario,
        Stretch,
        Trajectory,
    )

__all__ = [
    "Account",
    "Alternative",
    "Box",
    "Choice",
    "ConstantAcceleration",
    "Ego",
    "Footprints",
    "MissingLane",
    "MotionBounds",
    "Obstacle",
    "Road",
    "Scenario",
    "Stretch",
    "Trajectory",
    "available_scenarios",
    "load_scenario",
]

_HOME = {
    "Box": "geometry",
    "MotionBounds": "motion_bounds",
    "available_scenarios": "scenario_files",
    "load_scenario": "scenario_files",
}
"""The modules of the exported names that are not in ``scenario_model``."""


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME.get(name, 'scenario_model')}"), name)
