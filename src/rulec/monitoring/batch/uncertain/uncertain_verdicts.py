"""Verdicts on many traces of one shape with unknown values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.uncertain.uncertain_engine import uncertain_outcomes
from rulec.monitoring.uncertainty.judged_rules import JudgedRules
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun, presumed_in
from rulec.monitoring.verdict import OpenReasons, OpenVerdict, Verdict, Violation
from rulec.trace import Trace
from rulec.trace.trace_columns import TraceColumns


def uncertain_verdicts(
    columns: TraceColumns,
    traces: Sequence[Trace],
    rulebook: CompiledRulebook,
    judged: JudgedRules,
) -> Iterator[Verdict | None]:
    """A verdict for each trace, in the layout's order.

    None where the trace must be judged by itself.

    Raises NotGivenError if a rule needs a value that is not given and has no default.
    """
    unread: set[int] = set()
    violations: dict[int, list[Violation]] = {}
    doubtful: dict[int, list[OpenVerdict]] = {}
    later = [_LaterReasons(trace, rulebook) for trace in traces]
    places = {name: place for place, name in enumerate(columns.objects)}
    objects = [tuple(trace.objects) for trace in traces]
    for outcomes in uncertain_outcomes(columns, rulebook, judged):
        rule, bound = outcomes.binding.rule, outcomes.binding.objects
        chosen = [(variable, places[item]) for variable, item in bound.items()]
        known: dict[tuple[str, ...], Mapping[str, str]] = {}

        def own(
            number: int,
            chosen: Sequence[tuple[str, int]] = tuple(chosen),
            known: dict[tuple[str, ...], Mapping[str, str]] = known,
        ) -> Mapping[str, str]:
            names = objects[number]
            if names not in known:
                known[names] = {variable: names[place] for variable, place in chosen}
            return known[names]

        unread.update(outcomes.unread.tolist())
        lost = zip(outcomes.violated.tolist(), outcomes.lost_at.tolist(), strict=True)
        for number, step in lost:
            violation = Violation(rule.name, rule.strength, own(number), None if step < 0 else step)
            violations.setdefault(number, []).append(violation)
        for number in outcomes.open.tolist():
            binding = own(number)
            reasons = partial(later[number].of, rule.name, binding)
            verdict = OpenVerdict.explained_later(rule.name, rule.strength, binding, reasons)
            doubtful.setdefault(number, []).append(verdict)
    is_partial = _are_partial(columns)
    for number, trace in enumerate(traces):
        if number in unread:
            yield None
            continue
        found_here = tuple(violations.get(number, ()))
        if not is_partial[number] and trace.ends == "complete" and trace.told is None:
            yield Verdict(trace.id, found_here)
            continue
        presumed = presumed_in(trace, judged.presumed)
        unsettled = tuple(doubtful.get(number, ()))
        yield Verdict(trace.id, found_here, unsettled, judged.not_judged, presumed)


def _are_partial(columns: TraceColumns) -> NDArray[np.bool_]:
    """Whether each trace has an unknown value."""
    layout = columns.layout
    states = np.zeros(layout.n_states, dtype=bool)
    for unknown in columns.unknown.values():
        states |= unknown
    for key, upper in columns.upper.items():
        states |= upper != columns.values[key]
    traces = np.zeros(layout.n_traces, dtype=bool)
    traces[layout.traces_at(np.flatnonzero(states))] = True
    return traces


class _LaterReasons:
    """Why verdicts on a trace are open, computed for each verdict on demand."""

    def __init__(self, trace: Trace, rulebook: CompiledRulebook) -> None:
        self._trace = trace
        self._rulebook = rulebook

    @cached_property
    def _run(self) -> UncertainRun:
        return UncertainRun(spelled_out(self._trace, self._rulebook.vocabulary), self._rulebook)

    def of(self, rule: str, binding: Mapping[str, str]) -> OpenReasons:
        return self._run.reasons(rule, binding)
