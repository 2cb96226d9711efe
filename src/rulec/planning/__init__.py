"""Navigation graphs evaluated by compiled rulebooks."""

from rulec.planning.maneuvers import Maneuvers, evaluate
from rulec.planning.partition_choice import partition_for
from rulec.planning.results import Pruning, RankedManeuver

__all__ = ["Maneuvers", "Pruning", "RankedManeuver", "evaluate", "partition_for"]
