"""Verdicts on many traces of one shape with unknown values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.batch.alike_traces import AlikeTraces
from rulec.monitoring.batch.uncertain.uncertain_engine import uncertain_outcomes
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun
from rulec.monitoring.verdict import OpenReasons, OpenVerdict, Verdict, Violation
from rulec.trace import Trace
from rulec.trace.trace_columns import TraceColumns


def uncertain_verdicts(alike: AlikeTraces, rulebook: CompiledRulebook) -> Iterator[Verdict | None]:
    """A verdict for each trace, in the layout's order.

    None where the trace must be judged by itself.

    Raises NotGivenError if a rule needs a value that is not given and has no default.
    """
    columns, is_cut = alike.columns, alike.ends == "cut"
    judged = judged_rules(rulebook, alike.told, cut=is_cut)
    numbers = range(columns.layout.n_traces)
    unread: set[int] = set()
    violations: dict[int, list[Violation]] = {}
    doubtful: dict[int, list[OpenVerdict]] = {}
    later = [_LaterReasons(partial(alike.traces, number), rulebook) for number in numbers]
    places = {name: place for place, name in enumerate(columns.objects)}
    objects = [alike.names(number) for number in numbers]
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
    is_known = alike.told is None and not is_cut
    is_partial = _are_partial(columns)
    for number in numbers:
        if number in unread:
            yield None
            continue
        found_here = tuple(violations.get(number, ()))
        if is_known and not is_partial[number]:
            yield Verdict(alike.ids(number), found_here)
            continue
        presumed = tuple([name for name in judged.presumed if not alike.says(number, name)])
        unsettled = tuple(doubtful.get(number, ()))
        yield Verdict(alike.ids(number), found_here, unsettled, judged.not_judged, presumed)


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

    def __init__(self, trace: Callable[[], Trace], rulebook: CompiledRulebook) -> None:
        self._trace = trace
        self._rulebook = rulebook

    @cached_property
    def _run(self) -> UncertainRun:
        vocabulary = self._rulebook.vocabulary
        trace = with_derived_values(spelled_out(self._trace(), vocabulary), vocabulary)
        return UncertainRun(trace, self._rulebook)

    def of(self, rule: str, binding: Mapping[str, str]) -> OpenReasons:
        return self._run.reasons(rule, binding)
