"""Scenarios: the road, ego, the obstacles with their predictions, and reading scenarios from files.

Names are imported on first use, because a recorded drive needs only few of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.lazy_loading import lazy_names

if TYPE_CHECKING:
    from rulec.scenario.geometry import Box as Box
    from rulec.scenario.motion_bounds import MotionBounds as MotionBounds
    from rulec.scenario.scenario_files import available_scenarios as available_scenarios
    from rulec.scenario.scenario_files import load_scenario as load_scenario
    from rulec.scenario.scenario_model import Account as Account
    from rulec.scenario.scenario_model import Alternative as Alternative
    from rulec.scenario.scenario_model import Choice as Choice
    from rulec.scenario.scenario_model import ConstantAcceleration as ConstantAcceleration
    from rulec.scenario.scenario_model import Ego as Ego
    from rulec.scenario.scenario_model import Footprints as Footprints
    from rulec.scenario.scenario_model import MissingLane as MissingLane
    from rulec.scenario.scenario_model import Obstacle as Obstacle
    from rulec.scenario.scenario_model import Road as Road
    from rulec.scenario.scenario_model import Scenario as Scenario
    from rulec.scenario.scenario_model import Stretch as Stretch
    from rulec.scenario.scenario_model import Trajectory as Trajectory
else:
    __getattr__ = lazy_names(__name__)
