"""The door of the commands: names that are imported when a command first uses them.

A command's file itself imports what its help shows, which completion needs with each key (85 ms);
a command waits for what its options ask for alone (20 to 600 ms), and an error for its own words.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.lazy_loading import lazy_names

if TYPE_CHECKING:
    import shutil
    from tempfile import TemporaryDirectory
    from threading import Timer, get_ident
    from traceback import print_exception

    from click.shell_completion import CompletionItem

    from rulec.analysis.audit.rulebook_audit import Audit, compare_audits
    from rulec.analysis.audit.saved_audit import read_audits
    from rulec.analysis.audit.source_audit import SourceAudit
    from rulec.analysis.diff.comparison_matrix import ComparisonMatrix, growing_matrices
    from rulec.analysis.diff.rulebook_comparison import RulebookDiff, rules_matching
    from rulec.analysis.lineage.book_lineage import book_header, read_with_lineage
    from rulec.analysis.lineage.rule_lineage import extension_forest
    from rulec.api.pictures import drive_drawing, graph_drawing, scene_drawing, trace_drawing
    from rulec.api.rulebook_compilation import machines
    from rulec.automata.bundle import renamed_rulebook
    from rulec.automata.bundle.bundle_file import read_compiled
    from rulec.automata.bundle.bundle_proof import compiled_files, proofs_of_file
    from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
    from rulec.automata.bundle.required_signature import in_force as signature_in_force
    from rulec.batch import spreading
    from rulec.batch.drive_batch import WrittenDrives, in_vehicle_order
    from rulec.batch.example_batch import ExampleRequest, measured_runs
    from rulec.batch.recording_judge import JudgeSettings
    from rulec.book_tests import example_runs
    from rulec.book_tests.example_coverage import RuleCoverage, uncovered_verdicts
    from rulec.book_tests.example_runs import ExampleRun, is_chosen
    from rulec.cli import main, usage_help
    from rulec.cli.recording_run import RecordingRun
    from rulec.cli.trace_run import TraceRun
    from rulec.cli.usage_help import unknown_verb, ways_out
    from rulec.cli.verdict_run import VerdictRun
    from rulec.enforced_limits import enforced, limit_error
    from rulec.extraction.moment_search import DriveMoments, Look, in_recordings, in_traces
    from rulec.extraction.selection import RequestedDrives
    from rulec.extraction.traces.assumed_values import assumption_options
    from rulec.extraction.traffic_thresholds import Thresholds, threshold_options
    from rulec.files import file_messages
    from rulec.fleet.drive_rows import DriveRows, judged_by
    from rulec.fleet.finding_columns import COLUMNS
    from rulec.fleet.runs import fleet_summary
    from rulec.fleet.runs.fleet_run import FleetRun, FleetSettings, run_fleet
    from rulec.language_server.server import serve
    from rulec.monitoring.assumptions import Assumptions
    from rulec.monitoring.batch.by_states import rulebook_for_trace
    from rulec.monitoring.explain.explanation import Explanation, explain
    from rulec.monitoring.moments.drive_facts import DriveFacts, facts_of_many
    from rulec.monitoring.moments.formula_moments import moments
    from rulec.monitoring.moments.opportunity_outcomes import opportunities_of
    from rulec.monitoring.online import monitor_sources
    from rulec.monitoring.online.running_monitor import RunningMonitor
    from rulec.partition import NavigationGraph
    from rulec.planning import Maneuvers
    from rulec.planning.probability.rule_probability import (
        RuleProbabilities,
        alternative_counts,
        rule_probabilities,
    )
    from rulec.planning.product.graph_product import count_paths
    from rulec.planning.ranking.cheapest import Maneuver
    from rulec.planning.trace_history import read_past
    from rulec.rates.drive_counts import GroupKey
    from rulec.rates.rule_rates import rates_of_findings
    from rulec.recordings.recording_files import is_beside_recordings
    from rulec.recordings.recording_format import RecordingSource
    from rulec.report import json_document
    from rulec.report.automata import automaton_model, automaton_picture
    from rulec.report.automata.automaton_layout import is_too_large
    from rulec.report.automata.automaton_model import Automaton
    from rulec.report.findings import diagnostics_text
    from rulec.report.findings.code_registry import all_codes
    from rulec.report.findings.diagnostics_json import as_json as diagnostics_as_json
    from rulec.report.findings.diagnostics_json import codes_as_json
    from rulec.report.findings.diagnostics_text import print_diagnostics
    from rulec.report.findings.finding_mcap import McapWriter
    from rulec.report.findings.finding_tables import FindingTable, RowWriter
    from rulec.report.findings.findings_of_drives import not_judged_file
    from rulec.report.findings.findings_of_traces import not_judged_trace, trace_findings
    from rulec.report.findings.junit import JUnitWriter
    from rulec.report.findings.sarif import SarifWriter, as_sarif
    from rulec.report.findings.verdict_finding import FindingContext, RecordingFindings
    from rulec.report.maneuvers import maneuver_json, maneuver_report
    from rulec.report.maneuvers.envelope_table import write_envelopes
    from rulec.report.maneuvers.maneuver_report import ManeuverAnswers, ManeuverCounts
    from rulec.report.moments import moment_rows, word_values
    from rulec.report.pictures.drawing import picture_formats
    from rulec.report.pictures.drawing.picture_formats import Drawing
    from rulec.report.rates import rates_table
    from rulec.report.rates.rates_picture import rates_drawing
    from rulec.report.recordings import format_listing
    from rulec.report.rulebooks import (
        audit_report,
        lineage_tree,
        proof_report,
        rule_list,
        rule_page,
        word_texts,
    )
    from rulec.report.rulebooks.comparison import diff_formats, matrix_report, topic_report
    from rulec.report.rulebooks.rule_page import RulePage, page_of
    from rulec.report.rulebooks.word_texts import readers_of, words_as_json
    from rulec.report.tests import example_formats, example_text
    from rulec.report.tests.example_text import Besides
    from rulec.report.text import listing
    from rulec.report.text.listing import Listed
    from rulec.report.text.outgoing import outgoing
    from rulec.report.verdicts import running_verdicts, verdict_json, verdict_report
    from rulec.report.verdicts.batch_table import BatchTally, as_columns
    from rulec.report.verdicts.recording_answer import AnswerLayout
    from rulec.report.verdicts.recording_json import as_json as recording_line
    from rulec.report.verdicts.violation_table import tables
    from rulec.resource_limits import in_force as limits_in_force
    from rulec.rulebook.batch.batch_check import find_sources, named_rulebooks
    from rulec.rulebook.batch.batch_fix import write_fixes
    from rulec.rulebook.files import words_in_files
    from rulec.rulebook.files.catalogue import named_by_heads, rulebook_heads, rulebooks_with_rule
    from rulec.rulebook.files.search_path import available_rulebooks
    from rulec.rulebook.files.words_in_files import definitions_of_rulebooks
    from rulec.rulebook.names import word_meanings
    from rulec.rulebook.query_reader import read_query
    from rulec.rulebook.reading.rulebook_reader import load_rulebook, read_rulebook
    from rulec.rulebook.rulebook_model import Rule, Rulebook
    from rulec.rulebook.rules.rule_topics import on_topic
    from rulec.rulebook.word_search import FoundWord, find_word
    from rulec.scenario import Choice, Scenario, available_scenarios, load_scenario
    from rulec.scenario.scenario_model import PREDICTIONS, is_distribution
    from rulec.scoring.maneuver_trajectories import TrajectoryScores, trajectory_scores
    from rulec.syntax.messages.literals import why_not_a_day
    from rulec.syntax.tree_printer import print_in_force
    from rulec.trace.formats import json_lines, trace_files
    from rulec.trace.formats.json_line_problems import LONGEST_LINE_BYTES
    from rulec.trace.formats.json_lines import read_live
    from rulec.trace.formats.trace_files import (
        Format,
        format_of,
        kinds_in,
        read_chunks,
        read_traces,
    )
    from rulec.validation.file_proof import RuleProof
else:
    __getattr__ = lazy_names(__name__)
