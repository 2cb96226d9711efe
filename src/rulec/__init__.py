"""A compiler for traffic law: rulebooks in, automata out, maneuvers judged.

An overview::

    import rulec

    rules = rulec.compile_rulebook("esterle2019")     # a name, a source path, a compiled file
    verdict = rulec.verify(trace, rules)              # a rulec.Trace; see rulec.read_traces
    graph = rulec.navigation_graph("s2", step_s=0.5)  # cells, adjacency; graph.to_networkx()
    found = rulec.find_maneuvers("s2", rules)         # counts, and the cheapest ones lazily

A ``rulec.Session`` has the same verbs with its own search path and day of law. Errors in inputs are
raised as ``rulec.RulecError``, with the diagnostics as data. Modules are imported on first use.
"""

from __future__ import annotations

# Nothing is imported here: until the command line has set its signal handlers, Ctrl-C would print
# a traceback. Type checkers take this name for true.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from rulec.analysis.audit.provision_coverage import ListedProvision as ListedProvision
    from rulec.analysis.audit.rulebook_audit import Audit as Audit
    from rulec.analysis.audit.rulebook_audit import AuditCounts as AuditCounts
    from rulec.analysis.audit.rulebook_audit import AuditFinding as AuditFinding
    from rulec.analysis.audit.rulebook_audit import CitedArticle as CitedArticle
    from rulec.analysis.audit.source_audit import RuleBasis as RuleBasis
    from rulec.analysis.audit.source_audit import SourceAudit as SourceAudit
    from rulec.analysis.diff.rule_comparison import RuleComparison as RuleComparison
    from rulec.analysis.diff.rulebook_comparison import OneSided as OneSided
    from rulec.analysis.diff.rulebook_comparison import RulebookDiff as RulebookDiff
    from rulec.analysis.diff.rulebook_comparison import RulePair as RulePair
    from rulec.analysis.diff.rulebook_comparison import SettingPair as SettingPair
    from rulec.analysis.lineage.rule_lineage import BookLineage as BookLineage
    from rulec.analysis.lineage.rule_lineage import RuleHistory as RuleHistory
    from rulec.api.judged_drives import FindingRows as FindingRows
    from rulec.api.judged_drives import JudgedDrives as JudgedDrives
    from rulec.api.judged_drives import JudgedTraces as JudgedTraces
    from rulec.api.named_monitor import Monitor as Monitor
    from rulec.api.session import Session as Session
    from rulec.api.verbs import *  # noqa: F403 - every verb
    from rulec.automata.bundle.compiled_rulebook import CompiledRule as CompiledRule
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook as CompiledRulebook
    from rulec.automata.mealy_monitor import MealyMonitor as MealyMonitor
    from rulec.book_tests.example_coverage import RuleCoverage as RuleCoverage
    from rulec.book_tests.example_runs import ExampleOutcome as ExampleOutcome
    from rulec.book_tests.example_runs import ExampleRun as ExampleRun
    from rulec.book_tests.proposed_examples import UncoveredEdge as UncoveredEdge
    from rulec.book_tests.proposed_examples import UntouchedLimit as UntouchedLimit
    from rulec.diagnostics import Diagnostic as Diagnostic
    from rulec.diagnostics import Fix as Fix
    from rulec.diagnostics import Label as Label
    from rulec.diagnostics import Offer as Offer
    from rulec.diagnostics import RulecError as RulecError
    from rulec.diagnostics import SourceLocation as SourceLocation
    from rulec.extraction.moment_search import DriveMoments as DriveMoments
    from rulec.extraction.recording_verdicts import DriveVerdict as DriveVerdict
    from rulec.extraction.recording_verdicts import RecordingVerdicts as RecordingVerdicts
    from rulec.extraction.selection import RequestedDrives as RequestedDrives
    from rulec.extraction.traces.recorded_drive import Drive as Drive
    from rulec.extraction.traces.recorded_drive import NoDrive as NoDrive
    from rulec.extraction.traffic_thresholds import Thresholds as Thresholds
    from rulec.monitoring.assumptions import Assumptions as Assumptions
    from rulec.monitoring.batch.cell_verdicts import VerdictColumns as VerdictColumns
    from rulec.monitoring.explain.explanation import Explanation as Explanation
    from rulec.monitoring.moments.formula_moments import Moment as Moment
    from rulec.monitoring.online.four_valued import VerdictRange as VerdictRange
    from rulec.monitoring.online.monitor_state import SoFar as SoFar
    from rulec.monitoring.online.monitor_state import VerdictChange as VerdictChange
    from rulec.monitoring.verdict import ConditionalOutcome as ConditionalOutcome
    from rulec.monitoring.verdict import NotJudged as NotJudged
    from rulec.monitoring.verdict import OpenVerdict as OpenVerdict
    from rulec.monitoring.verdict import RuleNotJudged as RuleNotJudged
    from rulec.monitoring.verdict import Verdict as Verdict
    from rulec.monitoring.verdict import Violation as Violation
    from rulec.partition import Cell as Cell
    from rulec.partition import Envelope as Envelope
    from rulec.partition import Layer as Layer
    from rulec.partition import NavigationGraph as NavigationGraph
    from rulec.planning import Maneuvers as Maneuvers
    from rulec.planning import RankedManeuver as RankedManeuver
    from rulec.planning import RulePruning as RulePruning
    from rulec.planning.probability.rule_probability import AlternativeCounts as AlternativeCounts
    from rulec.planning.probability.rule_probability import RuleProbabilities as RuleProbabilities
    from rulec.planning.probability.rule_probability import RuleProbability as RuleProbability
    from rulec.planning.ranking.cheapest import Maneuver as Maneuver
    from rulec.planning.ranking.homotopy import HomotopyClasses as HomotopyClasses
    from rulec.planning.ranking.homotopy import Variant as Variant
    from rulec.planning.ranking.penalties import PenaltyRank as PenaltyRank
    from rulec.rates.finding_rows import FindingRow as FindingRow
    from rulec.rates.rule_rates import Rate as Rate
    from rulec.rates.rule_rates import RuleRates as RuleRates
    from rulec.rates.rule_rates import ViolationRates as ViolationRates
    from rulec.recordings.building import build_lanelet as build_lanelet
    from rulec.recordings.building import build_participant as build_participant
    from rulec.recordings.building import build_recording as build_recording
    from rulec.recordings.map_files import read_map as read_map
    from rulec.recordings.recording import Lanelet as Lanelet
    from rulec.recordings.recording import Light as Light
    from rulec.recordings.recording import ObservedLight as ObservedLight
    from rulec.recordings.recording import Participant as Participant
    from rulec.recordings.recording import PlanningProblem as PlanningProblem
    from rulec.recordings.recording import Recording as Recording
    from rulec.recordings.recording import TrackState as TrackState
    from rulec.recordings.recording import Weather as Weather
    from rulec.recordings.recording_format import RecordingSource as RecordingSource
    from rulec.recordings.road_map import RoadMap as RoadMap
    from rulec.recordings.tracks.track_table import recording_from_columns as recording_from_columns
    from rulec.report.findings.code_registry import CodeExplanation as CodeExplanation
    from rulec.report.findings.verdict_finding import VerdictFinding as VerdictFinding
    from rulec.report.recordings.format_listing import ListedFormat as ListedFormat
    from rulec.report.text.listing import Listed as Listed
    from rulec.rulebook.batch.batch_check import Checked as Checked
    from rulec.rulebook.rulebook_model import Example as Example
    from rulec.rulebook.rulebook_model import Rule as Rule
    from rulec.rulebook.rulebook_model import Rulebook as Rulebook
    from rulec.rulebook.rulebook_model import Variable as Variable
    from rulec.scenario import Choice as Choice
    from rulec.scenario import Scenario as Scenario
    from rulec.scoring.candidate_score import CandidateScore as CandidateScore
    from rulec.scoring.score_margins import RuleMargin as RuleMargin
    from rulec.scoring.scores import Scores as Scores
    from rulec.scoring.traffic_world import TrafficWorld as TrafficWorld
    from rulec.trace import Trace as Trace
    from rulec.trace import TraceGraph as TraceGraph
    from rulec.trace.trace_columns import TraceCells as TraceCells
    from rulec.trace.trace_columns import TraceColumns as TraceColumns
    from rulec.trace.trace_columns import layout_of as layout_of
    from rulec.validation.file_proof import RuleProof as RuleProof
    from rulec.version import __version__ as __version__
    from rulec.vocabulary import Vocabulary as Vocabulary
    from rulec.vocabulary.partial_values import UNKNOWN as UNKNOWN
    from rulec.vocabulary.partial_values import Interval as Interval


def __getattr__(name: str) -> Any:
    # Here, so that importing the package imports nothing.
    from importlib import import_module

    if name == "fleet":
        return import_module("rulec.fleet")  # also public
    lazy = import_module("rulec.lazy_loading")
    public = [own for own, (home, _) in lazy.homes(__name__).items() if home.startswith("rulec.")]
    if name == "__all__":
        return public
    if name not in public:
        raise AttributeError(f"module 'rulec' has no attribute {name!r}")
    # Stored, so that it is found without this function from now on.
    found = globals()[name] = lazy.lazy_names(__name__)(name)
    return found


def __dir__() -> Sequence[str]:
    return sorted(__getattr__("__all__"))
