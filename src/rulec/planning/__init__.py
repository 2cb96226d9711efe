"""Navigation graphs evaluated by compiled rulebooks."""

from rulec.planning.maneuvers import Maneuvers, evaluate
from rulec.planning.partition_choice import partition_for
from rulec.planning.results import RankedManeuver, RulePruning

__all__ = ["Maneuvers", "RankedManeuver", "RulePruning", "evaluate", "partition_for"]
