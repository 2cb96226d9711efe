"""Many traces of one shape, judged by every rule for every binding."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.cell_letters import Spelling
from rulec.monitoring.batch.column_reader import Reading
from rulec.monitoring.batch.joint_codes import walks
from rulec.monitoring.batch.rule_bindings import Task, tasks_of
from rulec.monitoring.batch.verdict_columns import Judged, Walk, judged
from rulec.trace.trace_columns import TraceCells, TraceColumns


def judge_columns(columns: TraceColumns, rulebook: CompiledRulebook) -> list[Judged]:
    """The verdicts on traces that are given as columns, in the order of rules and objects.

    Raises NotGivenError where a rule needs what is neither given nor has a default.
    """
    vocabulary = rulebook.vocabulary
    tasks = _tasks(columns, rulebook)
    reading = Reading(columns, vocabulary)
    found = [one for walk in walks(reading, tasks, vocabulary) for one in judged(walk)]
    return _in_order(found, tasks)


def judge_cells(traces: TraceCells, rulebook: CompiledRulebook) -> list[Judged]:
    """The same for traces that are given as walks; their states have passed ``check_state``."""
    tasks = _tasks(traces, rulebook)
    spelling = Spelling(traces, rulebook.vocabulary)
    together: dict[tuple[int, int | None], list[Task]] = {}
    for task in tasks:
        together.setdefault(task.stretch, []).append(task)
    found: list[Judged] = []
    for group in together.values():
        letters = [spelling.letters(task) for task in group]
        found += judged(Walk(traces.layout, traces.cells, group, letters))
    return _in_order(found, tasks)


def _tasks(traces: TraceColumns | TraceCells, rulebook: CompiledRulebook) -> list[Task]:
    n_steps = traces.layout.n_steps
    return list(
        tasks_of(rulebook.rules, rulebook.vocabulary, traces.objects, traces.present, n_steps)
    )


def _in_order(found: Sequence[Judged], tasks: Sequence[Task]) -> list[Judged]:
    by_task = {id(one.task): one for one in found}
    return [by_task[id(task)] for task in tasks]
