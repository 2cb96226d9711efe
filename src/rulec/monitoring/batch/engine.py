"""Many traces of one shape, judged by every rule for every binding."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.cell_letters import Spelling
from rulec.monitoring.batch.column_reader import ColumnReader
from rulec.monitoring.batch.joint_codes import walks
from rulec.monitoring.batch.rule_bindings import RuleBinding, rule_bindings
from rulec.monitoring.batch.verdict_columns import VerdictColumns, Walk, verdict_columns
from rulec.trace.trace_columns import TraceCells, TraceColumns


def verify_columns(columns: TraceColumns, rulebook: CompiledRulebook) -> list[VerdictColumns]:
    """The verdicts on traces that are given as columns, in the order of rules and objects.

    Raises NotGivenError where a rule needs what is neither given nor has a default.
    """
    vocabulary = rulebook.vocabulary
    tasks = _tasks(columns, rulebook)
    reading = ColumnReader(columns, vocabulary)
    found = [one for walk in walks(reading, tasks, vocabulary) for one in verdict_columns(walk)]
    return _in_order(found, tasks)


def verify_cells(traces: TraceCells, rulebook: CompiledRulebook) -> list[VerdictColumns]:
    """The same for traces that are given as walks; their states have passed ``check_state``."""
    tasks = _tasks(traces, rulebook)
    spelling = Spelling(traces, rulebook.vocabulary)
    together: dict[tuple[int, int | None], list[RuleBinding]] = {}
    for task in tasks:
        together.setdefault(task.stretch, []).append(task)
    found: list[VerdictColumns] = []
    for group in together.values():
        letters = [spelling.letters(task) for task in group]
        found += verdict_columns(Walk(traces.layout, traces.cells, group, letters))
    return _in_order(found, tasks)


def _tasks(traces: TraceColumns | TraceCells, rulebook: CompiledRulebook) -> list[RuleBinding]:
    n_steps = traces.layout.n_steps
    return list(
        rule_bindings(rulebook.rules, rulebook.vocabulary, traces.objects, traces.present, n_steps)
    )


def _in_order(
    found: Sequence[VerdictColumns], tasks: Sequence[RuleBinding]
) -> list[VerdictColumns]:
    by_task = {id(one.task): one for one in found}
    return [by_task[id(task)] for task in tasks]
