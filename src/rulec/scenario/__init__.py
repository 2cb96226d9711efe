"""Scenarios: the road, ego, obstacles and their prediction; reading them from files."""

from rulec.scenario.geometry import Box
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
    "Obstacle",
    "Road",
    "Scenario",
    "Stretch",
    "Trajectory",
    "available_scenarios",
    "load_scenario",
]
