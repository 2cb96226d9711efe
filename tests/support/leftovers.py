"""What does not keep the house's rules yet; a line here is a debt, and goes when it is paid."""

POSITIONAL_CALLS = frozenset(
    {
        "analysis/audit/rulebook_audit.py Audit",
        "analysis/audit/rulebook_audit.py AuditCounts",
        "analysis/lineage/book_lineage.py BookHeader",
        "api/rulebook_questions.py diff_rulebooks",
        "cli/commands/diff.py _all",
        "cli/commands/diff.py _difference",
        "cli/commands/diff.py compare_rulebooks",
        "cli/commands/show.py Rule",
        "cli/commands/traces.py _write_drives",
        "diagnostics/code.py Diagnostic",
        "diagnostics/source_text.py SourceLocation",
        "file_messages.py SourceLocation",
        "logic/causes.py _of_search",
        "monitoring/batch/block_columns.py BlockGroup",
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
        "api/workflow.py",
        "automata/spot_worker.py",
        "cli/commands/analyze.py",
        "cli/commands/audit.py",
        "cli/commands/check.py",
        "cli/commands/compile.py",
        "cli/commands/completion.py",
        "cli/commands/diff.py",
        "cli/commands/doc.py",
        "cli/commands/draw.py",
        "cli/commands/draw_trace.py",
        "cli/commands/envelopes.py",
        "cli/commands/explain.py",
        "cli/commands/fmt.py",
        "cli/commands/list.py",
        "cli/commands/maneuvers.py",
        "cli/commands/monitor.py",
        "cli/commands/new.py",
        "cli/commands/show.py",
        "cli/commands/test.py",
        "cli/commands/traces.py",
        "cli/commands/tree.py",
        "cli/commands/verify.py",
        "cli/entry_point.py",
        "cli/main.py",
        "cli/options/picture_options.py",
        "cli/options/recording_options.py",
        "cli/options/scenario_options.py",
        "cli/options/shared_options.py",
        "cli/options/shell_completion.py",
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
WIDE_FOLDERS = frozenset(
    {
        "monitoring/batch",
        "monitoring/online",
    }
)
MODULES_TWICE = frozenset(
    {
        "axioms",
        "bounds",
        "limits",
        "literals",
        "model",
    }
)
CLASSES_TWICE = frozenset(
    {
        "Part",
        "Quantity",
    }
)
ROOMS_WITHOUT_README = frozenset(
    {
        "analysis",
        "analysis/audit",
        "analysis/diff",
        "analysis/lineage",
        "analysis/lint",
        "api",
        "automata",
        "automata/bundle",
        "automata/spot_bridge",
        "book_tests",
        "logic",
        "logic/english",
        "monitoring",
        "monitoring/batch",
        "monitoring/batch/machines",
        "monitoring/explain",
        "monitoring/online",
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
        "witnesses",
    }
)
LINES_TOO_MANY = 3_700
