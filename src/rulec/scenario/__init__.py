"""Scenarios: the road, ego, obstacles and their prediction; reading them from files.

The way through: ``read`` a TOML file -> ``schema``, ``fields``: its tables, field by field ->
``convert``, ``obstacles``, ``check``: the ``model``. What is wrong is collected in ``Findings``,
each in its place, which ``toml_places`` finds. ``recordings`` reads recorded scenes:
``commonroad`` and ``sumo`` know their formats, ``recorded`` makes scenarios of them.
``motion`` says where an obstacle is at what time.
"""

from rulec.scenario.geometry import Box
from rulec.scenario.model import (
    Account,
    Alternative,
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
from rulec.scenario.recorded.scene_choice import Choice
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
