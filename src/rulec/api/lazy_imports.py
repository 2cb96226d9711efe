"""The door of the verbs: names that are imported when a verb first uses them.

A session alone takes 25 ms to import, all that its verbs need 340 ms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.lazy_loading import lazy_names

if TYPE_CHECKING:
    from rulec.analysis.audit import rulebook_audit
    from rulec.analysis.audit.law_text import read_law_text
    from rulec.analysis.audit.source_audit import audit_source
    from rulec.analysis.diff.rulebook_comparison import diff_rulebooks, setting_pairs
    from rulec.analysis.lineage.book_lineage import read_with_lineage
    from rulec.analysis.lint.changing_lines import changing_lines
    from rulec.analysis.lint.rulebook_findings import rulebook_findings
    from rulec.api import pictures
    from rulec.api.judged_drives import JudgedDrives, JudgedTraces
    from rulec.api.pictures import drive_drawing
    from rulec.api.rulebook_compilation import compile_rulebook, machines
    from rulec.automata import compiled_cache, compiler, second_compiler
    from rulec.automata.bundle.bundle_file import read_compiled, write_compiled
    from rulec.automata.bundle.bundle_proof import proofs_of_file
    from rulec.automata.prefix_machines import prefix_machines, timed_cuts
    from rulec.automata.second_compiler import with_automata
    from rulec.automata.step_compilation import StepCompiler, build_automata
    from rulec.automata.thresholds import exact_step
    from rulec.batch.example_batch import ExampleRequest, run_examples
    from rulec.book_tests import example_coverage
    from rulec.book_tests.example_runs import run_rulebook_examples
    from rulec.cell_words import cell_words, on_side_of
    from rulec.code_generation.monitor_files import write_monitor
    from rulec.extraction.moment_search import in_recordings, in_traces
    from rulec.extraction.recording_verdicts import RecordingVerdicts
    from rulec.extraction.selection import RequestedDrives, selected_drives
    from rulec.extraction.tellable_words import TELLABLE_WORDS
    from rulec.extraction.traces.tellable_types import told_types
    from rulec.extraction.violation_evidence import explain_drive
    from rulec.logic.bounds import has_seconds, longest_divisor
    from rulec.logic.sentences.language import LANGUAGES
    from rulec.ltl_export.ltl_files import write_ltl
    from rulec.monitoring.assumptions import Assumptions, check_assumed
    from rulec.monitoring.batch.batch_verify import verify_columns, verify_many
    from rulec.monitoring.batch.by_states import verify_by_states
    from rulec.monitoring.batch.cell_verdicts import verify_cells
    from rulec.monitoring.batch.verify import verify
    from rulec.monitoring.explain.explanation import explain
    from rulec.monitoring.rulebook_edition import edition_of
    from rulec.monitoring.verdict import with_law
    from rulec.partition import NavigationGraph, envelope, navigation_graph
    from rulec.pipeline import compile_source
    from rulec.planning import SceneReading, evaluate, partition_for
    from rulec.planning.probability.rule_probability import alternative_counts, rule_probabilities
    from rulec.rates.drive_counts import GroupKey
    from rulec.rates.rule_rates import rates_of_findings
    from rulec.recordings.recording import Recording
    from rulec.recordings.recording_files import is_recording, read_recording, read_recordings
    from rulec.recordings.recording_format import RecordingSource
    from rulec.report.findings.code_registry import all_codes
    from rulec.report.pictures.drawing import picture_formats
    from rulec.report.recordings.format_listing import listed_formats, words_in_order
    from rulec.report.rulebooks import rule_page
    from rulec.report.rulebooks.comparison import diff_text
    from rulec.report.rulebooks.document import book_document
    from rulec.report.rulebooks.document.book_document import contents_heading, title_of
    from rulec.report.rulebooks.document.example_picture import ExampleFigures
    from rulec.report.rulebooks.document_language import document_language
    from rulec.report.tests.example_text import missing_examples
    from rulec.report.text import html_page
    from rulec.report.text.listing import Listed
    from rulec.report.text.markdown import PageTexts
    from rulec.rulebook import template
    from rulec.rulebook.allowances import without_allowed
    from rulec.rulebook.batch import batch_check, batch_format
    from rulec.rulebook.files.catalogue import list_rulebooks, list_vocabularies
    from rulec.rulebook.loader import load_vocabulary, parse_rulebook, read_trees, resolve_trees
    from rulec.rulebook.query_reader import read_query
    from rulec.rulebook.reading.rulebook_reader import question_of, read_rulebook
    from rulec.scenario import Choice, available_scenarios, load_scenario
    from rulec.scenario.scenario_files import scene_of
    from rulec.scoring import score
    from rulec.scoring.maneuver_trajectories import score_trajectories
    from rulec.trace.formats.trace_files import (
        check_writable,
        format_of,
        is_partial,
        kinds_in,
        read_traces,
        write_traces,
    )
else:
    __getattr__ = lazy_names(__name__)
