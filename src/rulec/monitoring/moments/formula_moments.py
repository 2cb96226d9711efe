"""The moments at which a formula holds in a trace, for all choices of objects."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rulec.array_types import Flags
from rulec.automata.thresholds import exact_step
from rulec.logic.bounds import NotAMultipleError, in_steps
from rulec.logic.formula import Formula
from rulec.monitoring.moments.stretches import stretches_of
from rulec.monitoring.moments.trace_truth import (
    ReadyFormula,
    TraceTruth,
    tables_of,
)
from rulec.rulebook.query_model import FormulaQuery
from rulec.trace import Trace
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

    Moments are maximal. Bounds that are no multiple of the trace's step are rounded down and up;
    what holds under both is certain.
    """
    roundings = _in_steps(trace, query)
    tables = tables_of(trace, query.vocabulary)
    truth, n_states = TraceTruth(tables, query.semantics, trace.ends), tables.n_states
    choices = truth.choices_of(query.rule.variables)
    flags_of: dict[tuple[str, ...], list[tuple[Flags, Flags]]] = {}
    for rounded in roundings:
        ready = ReadyFormula(rounded, place=trace.place if isinstance(trace, Trace) else None)
        for part in truth.of(ready, choices):
            sure, possible = (flags[:, :n_states] for flags in part.in_trace())
            for row in np.flatnonzero(possible.any(axis=1)).tolist():
                choice = tuple([tables.objects[item] for item in part.choices.items[row]])
                flags_of.setdefault(choice, []).append((sure[row], possible[row]))
    result = []
    for choice, rows in flags_of.items():
        possible = np.any([flags for _, flags in rows], axis=0)
        sure = np.all([flags for flags, _ in rows], axis=0)
        sure &= len(rows) == len(roundings)
        objects = dict(zip(choices.variables, choice, strict=True))
        result += sorted(_of_one(objects, sure, possible), key=lambda moment: moment.first)
    return result


def _of_one(objects: Mapping[str, str], sure: Flags, possible: Flags) -> Iterator[Moment]:
    kinds: Sequence[tuple[Literal["surely", "perhaps"], Flags]] = (
        ("surely", sure),
        ("perhaps", possible & ~sure),
    )
    for holds, flags in kinds:
        stretches = stretches_of(flags[None])
        for first, last in zip(stretches.first.tolist(), stretches.last.tolist(), strict=True):
            yield Moment(objects, first, last, holds)


def _in_steps(trace: Trace | TraceArrays, query: FormulaQuery) -> list[Formula]:
    step = exact_step(trace.step_s)
    try:
        return [in_steps(query.rule.formula, step)]
    except NotAMultipleError:
        return [
            in_steps(query.rule.formula, step, rounding) for rounding in (math.floor, math.ceil)
        ]
