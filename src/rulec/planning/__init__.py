"""Navigation graphs evaluated by compiled rulebooks."""

from rulec.planning.maneuver_results import RankedManeuver, RulePruning
from rulec.planning.maneuvers import Maneuvers, evaluate
from rulec.planning.partition_choice import partition_for

__all__ = ["Maneuvers", "RankedManeuver", "RulePruning", "evaluate", "partition_for"]
