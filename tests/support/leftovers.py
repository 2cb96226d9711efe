"""What does not keep the house's rules yet; a line here is a debt, and goes when it is paid."""

POSITIONAL_CALLS = frozenset(
    {
        "api/rulebook_questions.py diff_rulebooks",
        "api/rulebook_verbs.py compare_rulebooks",
        "diagnostics/code.py Diagnostic",
        "diagnostics/source_text.py SourceLocation",
        "file_messages.py SourceLocation",
        "monitoring/batch/columns/block_columns.py BlockGroup",
        "monitoring/batch/trace_groups.py TraceCells",
        "monitoring/explain/explanation.py Explanation",
        "monitoring/explain/explanation.py Part",
        "monitoring/explain/explanation.py _parts",
        "monitoring/state_validation.py _check_value",
        "syntax/formatting/piece_rows.py group",
        "toml.py SourceLocation",
    }
)
UNEXPLAINED_IMPORTS = frozenset(
    {
        "api/rulebook_verbs.py",
        "api/scenario_verbs.py",
        "api/trace_verbs.py",
        "api/workflow.py",
        "automata/spot_worker.py",
        "partition/cells/cell_model.py",
        "planning/rule_instances.py",
        "scenario/commonroad/commonroad_file.py",
        "scenario/recording_files.py",
        "syntax/parser.py",
        "trace/arrow/arrow_library.py",
        "trace/arrow/parquet.py",
        "trace/formats/csv_table.py",
        "trace/formats/trace_files.py",
        "vocabulary/pint_units.py",
    }
)
WIDE_FOLDERS: frozenset[str] = frozenset()
MODULES_TWICE = frozenset(
    {
        "axioms",
        "bounds",
        "limits",
        "listing",
        "literals",
        "model",
        "settings",
    }
)
CLASSES_TWICE = frozenset(
    {
        "Quantity",
    }
)
ROOMS_WITHOUT_README = frozenset(
    {
        "api",
        "automata",
        "automata/bundle",
        "automata/spot_bridge",
        "logic",
        "logic/english",
        "monitoring",
        "monitoring/batch",
        "monitoring/batch/columns",
        "monitoring/batch/machines",
        "monitoring/explain",
        "monitoring/online",
        "monitoring/online/encoding",
        "rulebook",
        "rulebook/arithmetic",
        "rulebook/batch",
        "rulebook/elaborate",
        "rulebook/files",
        "rulebook/names",
        "rulebook/overlay",
        "rulebook/rules",
        "syntax/building",
        "syntax/formatting",
        "syntax/messages",
        "syntax/tree",
        "vocabulary",
    }
)
TYPES_WITHOUT_TERM = frozenset(
    {
        "AlternativeCounts",
        "Audit",
        "AuditCounts",
        "AuditFinding",
        "BookLineage",
        "Checked",
        "Choice",
        "Code",
        "CompiledRule",
        "DriveVerdict",
        "Example",
        "ExampleOutcome",
        "ExampleRun",
        "Label",
        "Listed",
        "NoDrive",
        "OneSided",
        "Participant",
        "PenaltyRank",
        "PlanningProblem",
        "RankedManeuver",
        "RecordingVerdicts",
        "RequestedDrives",
        "RuleComparison",
        "RuleCoverage",
        "RuleHistory",
        "RulePair",
        "RuleProbabilities",
        "RuleProbability",
        "RulePruning",
        "RulebookDiff",
        "Session",
        "SettingPair",
        "SoFar",
        "Thresholds",
        "TraceCells",
        "TraceColumns",
        "TraceGraph",
        "TrackState",
        "UncoveredEdge",
        "Variable",
        "Variant",
        "VerdictChange",
        "VerdictColumns",
    }
)
LINES_TOO_MANY = 4_800
