"""Batch engine: all rules and bindings on traces of one shape."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.cell_letters import CellLetterReader
from rulec.monitoring.batch.columns.column_reader import ColumnReader
from rulec.monitoring.batch.joint_codes import joint_cells_of
from rulec.monitoring.batch.rule_bindings import RuleBinding, rule_bindings
from rulec.monitoring.batch.verdict_columns import JointCells, VerdictColumns, verdict_columns
from rulec.trace.trace_columns import TraceCells, TraceColumns


def verify_columns(columns: TraceColumns, rulebook: CompiledRulebook) -> list[VerdictColumns]:
    """Verdicts on traces as columns, in the order of rules and objects.

    Raises NotGivenError where a rule needs what is neither given nor has a default.
    """
    vocabulary = rulebook.vocabulary
    bindings = _bindings_of(columns, rulebook)
    reader = ColumnReader(columns, vocabulary)
    verdicts = [
        verdict
        for cells in joint_cells_of(reader, bindings, vocabulary)
        for verdict in verdict_columns(cells)
    ]
    return _in_order(verdicts, bindings)


def verify_cells(traces: TraceCells, rulebook: CompiledRulebook) -> list[VerdictColumns]:
    """Verdicts on traces as cells, whose states have passed ``check_state``."""
    bindings = _bindings_of(traces, rulebook)
    reader = CellLetterReader(traces, rulebook.vocabulary)
    together: dict[tuple[int, int | None], list[RuleBinding]] = {}
    for binding in bindings:
        together.setdefault(binding.stretch, []).append(binding)
    verdicts: list[VerdictColumns] = []
    for group in together.values():
        letters = [reader.letters(binding) for binding in group]
        verdicts += verdict_columns(JointCells(traces.layout, traces.cells, group, letters))
    return _in_order(verdicts, bindings)


def _bindings_of(
    traces: TraceColumns | TraceCells, rulebook: CompiledRulebook
) -> list[RuleBinding]:
    n_steps = traces.layout.n_steps
    return list(
        rule_bindings(rulebook.rules, rulebook.vocabulary, traces.objects, traces.present, n_steps)
    )


def _in_order(
    verdicts: Sequence[VerdictColumns], bindings: Sequence[RuleBinding]
) -> list[VerdictColumns]:
    by_binding = {verdict.task: verdict for verdict in verdicts}
    return [by_binding[binding] for binding in bindings]
