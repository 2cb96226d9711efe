"""Columns of traces judged on bits: the verdicts of the batch engine, without machines."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.thresholds import exact
from rulec.logic.bounds import in_steps
from rulec.logic.formula import Atom, Comparison, Proposition
from rulec.monitoring.batch.cell_verdicts import RuleBinding, rule_bindings
from rulec.monitoring.batch.columns.column_numbers import Mask
from rulec.trace.trace_columns import Array, TraceColumns, layout_of
from support.oracles.bits.column_reading import ColumnReader, NotGivenError
from support.oracles.bits.trace_planes import Across


def verify_on_bits(
    columns: TraceColumns, rulebook: CompiledRulebook
) -> Iterator[tuple[RuleBinding, NDArray[np.bool_]]]:
    """For every rule and binding, in this order: which traces, in the layout's order, keep it.

    Raises NotGivenError where a rule needs what is neither given nor has a default.
    """
    reading = ColumnReader(columns, rulebook.vocabulary)
    together: dict[tuple[object, ...], Across] = {}
    for task in rule_bindings(columns, rulebook):
        # What is read of the same objects on the same stretch is packed into bits once.
        key = (*sorted(task.objects.items()), task.stretch)
        if key not in together:
            together[key] = _across(reading, task, rulebook)
        yield task, together[key].holds(in_steps(task.rule.formula, exact(columns.step_s)))


def _across(reading: ColumnReader, task: RuleBinding, rulebook: CompiledRulebook) -> Across:
    layout = reading.columns.layout
    part = slice(None)
    if task.last is not None:
        # All traces have these steps, so they stand side by side.
        part = slice(int(layout.starts[task.first]), int(layout.starts[task.last + 1]))
        layout = layout_of(np.full(layout.n_traces, task.last + 1 - task.first))
    return Across(layout, lambda one: _column(one, reading, task)[part], rulebook.semantics)


def _column(proposition: Proposition, reading: ColumnReader, task: RuleBinding) -> Array:
    n_states = reading.columns.layout.n_states
    true: Mask
    match proposition:
        case Atom(name, arguments, wanted):
            items = tuple([task.objects[one] for one in arguments])
            truth = reading.atom(name, items, wanted)
            if not np.ndim(truth.sure) and not truth.sure and truth.possible:
                raise NotGivenError(name, items)
            true = truth.sure
        case Comparison():
            true = reading.compared(proposition, task.objects)
    return np.asarray(true) if np.ndim(true) else np.full(n_states, true)
