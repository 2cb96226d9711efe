"""Where partition and rules meet: a navigation graph judged by a compiled rulebook."""

from rulec.planning.maneuvers import Maneuvers, judged
from rulec.planning.partition_choice import partition_for
from rulec.planning.results import Pruning, Ranked

__all__ = ["Maneuvers", "Pruning", "Ranked", "judged", "partition_for"]
