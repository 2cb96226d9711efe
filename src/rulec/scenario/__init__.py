"""Scenarios: the road, ego, obstacles and their prediction; reading them from files.

The readers of files are imported when they are asked for: recordings take the model alone.
"""

from typing import TYPE_CHECKING, Any

from rulec.scenario.geometry import Box
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

if TYPE_CHECKING:
    from rulec.scenario.scenario_files import available_scenarios, load_scenario

__all__ = [
    "Account",
    "Alternative",
    "Box",
    "Choice",
    "ConstantAcceleration",
    "Ego",
    "Footprints",
    "MissingLane",
    "Obstacle",
    "Road",
    "Scenario",
    "Stretch",
    "Trajectory",
    "available_scenarios",
    "load_scenario",
]


def __getattr__(name: str) -> Any:
    if name not in ("available_scenarios", "load_scenario"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # Readers of files, 10 ms: not for the scene of a recording.
    from rulec.scenario import scenario_files

    return getattr(scenario_files, name)
