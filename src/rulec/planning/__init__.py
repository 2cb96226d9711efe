"""Evaluating navigation graphs by compiled rulebooks."""

from rulec.planning.evaluation import evaluate
from rulec.planning.maneuvers import Maneuvers
from rulec.planning.ranking.least_violating import RankedManeuver
from rulec.planning.ranking.pruning import RulePruning
from rulec.planning.rule_instances import SceneReading, partition_for

__all__ = [
    "Maneuvers",
    "RankedManeuver",
    "RulePruning",
    "SceneReading",
    "evaluate",
    "partition_for",
]
