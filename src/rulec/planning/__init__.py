"""Evaluating navigation graphs by compiled rulebooks."""

from rulec.planning.evaluation import evaluate as evaluate
from rulec.planning.maneuvers import Maneuvers as Maneuvers
from rulec.planning.ranking.least_violating import RankedManeuver as RankedManeuver
from rulec.planning.ranking.pruning import RulePruning as RulePruning
from rulec.planning.rule_instances import SceneReading as SceneReading
from rulec.planning.rule_instances import partition_for as partition_for
