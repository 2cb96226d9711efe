"""Where partition and rules meet: a navigation graph judged by a compiled rulebook."""

from rulec.maneuvers.answers import Pruning, Ranked
from rulec.maneuvers.judging import Maneuvers, judged
from rulec.maneuvers.terms import partition_for

__all__ = ["Maneuvers", "Pruning", "Ranked", "judged", "partition_for"]
