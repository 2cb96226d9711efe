"""Scenarios: the road, ego, obstacles and their prediction; reading them from files."""

from rulec.scenario.geometry import Box
from rulec.scenario.model import (
    ConstantAcceleration,
    Ego,
    MissingLane,
    Obstacle,
    Road,
    Scenario,
    Stretch,
    Trajectory,
)
from rulec.scenario.read import available_scenarios, load_scenario

__all__ = [
    "Box",
    "ConstantAcceleration",
    "Ego",
    "MissingLane",
    "Obstacle",
    "Road",
    "Scenario",
    "Stretch",
    "Trajectory",
    "available_scenarios",
    "load_scenario",
]
