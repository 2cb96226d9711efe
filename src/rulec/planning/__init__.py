"""Where partition and rules meet: a navigation graph judged by a compiled rulebook."""

from rulec.planning.maneuvers import Maneuvers, evaluate
from rulec.planning.partition_choice import partition_for
from rulec.planning.results import Pruning, RankedManeuver

__all__ = ["Maneuvers", "Pruning", "RankedManeuver", "evaluate", "partition_for"]
