"""The moments at which a formula holds in a trace, for all choices of objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rulec.array_types import Flags
from rulec.automata.thresholds import exact_step
from rulec.logic.bounds import in_steps
from rulec.monitoring.moments.name_tables import tables_of
from rulec.monitoring.moments.stretches import stretches_of
from rulec.monitoring.moments.trace_truth import ReadyFormula, TraceTruth
from rulec.rulebook.query_model import FormulaQuery
from rulec.trace import Trace
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.trace_arrays import TraceArrays
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class Moment:
    """States ``first`` to ``last`` (both included) in which a formula holds for some objects.

    It holds ``surely``, or ``perhaps`` if that is unknown. ``objects`` are in the order of
    variables.
    """

    __repr__ = short_repr

    objects: Mapping[str, str]
    first: int
    last: int
    holds: Literal["surely", "perhaps"]


def moments(trace: Trace | TraceArrays, query: FormulaQuery) -> list[Moment]:
    """The moments at which a formula holds in a checked trace, by objects and time.

    Moments are maximal.
    """
    tables = tables_of(trace, query.vocabulary)
    truth, n_states = TraceTruth(tables, query.semantics, trace.ends), tables.n_states
    choices = truth.choices_of(query.rule.variables)
    formula = in_steps(query.rule.formula, exact_step(trace.step_s))
    ready = ReadyFormula(formula, place=trace.place if isinstance(trace, Trace) else None)
    result = []
    for part in truth.of(ready, choices):
        own = part.in_trace()
        for row in np.flatnonzero(own.possible[:, :n_states].any(axis=1)).tolist():
            choice = [tables.objects[item] for item in part.choices.items[row]]
            objects = dict(zip(choices.variables, choice, strict=True))
            of_row = Truth(own.sure[row, :n_states], own.possible[row, :n_states])
            result += sorted(_of_one(objects, of_row), key=lambda moment: moment.first)
    return result


def _of_one(objects: Mapping[str, str], truth: Truth) -> Iterator[Moment]:
    kinds: Sequence[tuple[Literal["surely", "perhaps"], Flags]] = (
        ("surely", truth.sure),
        ("perhaps", truth.unknown),
    )
    for holds, flags in kinds:
        stretches = stretches_of(flags[None])
        for first, last in zip(stretches.first.tolist(), stretches.last.tolist(), strict=True):
            yield Moment(objects, first, last, holds)
