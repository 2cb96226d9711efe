"""Assumptions about unknown values and about how traces end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from rulec.diagnostics import RulecError
from rulec.diagnostics.argument_kinds import expected_fields
from rulec.monitoring.monitoring_messages import STEP_TOO_FAR_OFF, UNFITTING_VALUE
from rulec.monitoring.state_validation import check_state
from rulec.trace import Trace, Value
from rulec.trace.trace_model import Ending
from rulec.value_display import brief
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval

_NOT_TOLD = UNKNOWN_TYPES - {Interval}

JITTER = 0.05
"""The largest relative difference between two time steps that counts as a logger's clock jitter."""


@dataclass(frozen=True, slots=True)
class Assumptions:
    """How traces end, and which values to assume where traces leave them unknown.

    ``values`` are for names that are not about objects. With ``defaults``, all other unknown values
    take their default, a number within bounds takes the middle of these, and traces are complete
    unless ``ends`` says otherwise. ``step_s`` replaces the step (s) of traces whose own step
    differs from it by at most the fraction ``JITTER``; other traces are refused.
    """

    ends: Ending | None = None
    values: Mapping[str, Value] = field(default_factory=dict)
    defaults: bool = False
    step_s: float | None = None

    def __post_init__(self) -> None:
        expected_fields(self)
        if self.ends not in (None, "complete", "cut"):
            raise ValueError(f"`ends` is complete or cut, not {brief(self.ends)}")

    def __bool__(self) -> bool:
        given = self.ends is not None or self.step_s is not None
        return given or bool(self.values) or self.defaults

    def applied(self, trace: Trace) -> Trace:
        """The trace with these assumptions; values that it contains are kept.

        Raises RulecError R0724.
        """
        told: object = trace.told
        if not isinstance(told, frozenset | tuple | None):
            return trace  # what is no trace is said by whoever judges
        untold = {} if told is None else {k: v for k, v in self.values.items() if k not in told}
        states = trace.states
        if self.values or self.defaults:
            states = tuple(
                {**untold, **self._with_assumed(state)} if isinstance(state, Mapping) else state
                for state in states
            )
        ends = self.ends or ("complete" if self.defaults else trace.ends)
        if self.defaults:
            told = None
        elif told is not None:
            told = frozenset(told).union(untold)
        return replace(trace, states=states, ends=ends, told=told, step_s=self._step_of(trace))

    def _step_of(self, trace: Trace) -> float:
        if self.step_s is None or not isinstance(trace.step_s, int | float):
            return trace.step_s  # what is no step at all is said by whoever judges
        if not abs(trace.step_s - self.step_s) <= JITTER * self.step_s:
            raise STEP_TOO_FAR_OFF.error(
                trace.place,
                f"trace `{trace.id}` has steps of {trace.step_s} s, which differ from the "
                f"{self.step_s} s of `--step` by more than a twentieth",
                help="judge it without `--step`, or bring it to that step",
            )
        return self.step_s

    def of(self, traces: Sequence[Trace | RulecError]) -> Sequence[Trace | RulecError]:
        """The traces with these assumptions; the same sequence if there are none."""
        if not self:
            return traces
        return [self._or_reason(item) for item in traces]

    def _or_reason(self, item: Trace | RulecError) -> Trace | RulecError:
        if isinstance(item, RulecError):
            return item
        try:
            return self.applied(item)
        except RulecError as error:
            return error

    def _with_assumed(self, state: Mapping[str, Any]) -> dict[str, Any]:
        values = self.values
        known = {
            name: values[name] if type(value) in _NOT_TOLD and name in values else value
            for name, value in state.items()
        }
        return _without_unknown(known) if self.defaults else known


def check_assumed(
    values: Mapping[str, Value], vocabulary: Vocabulary, given: str = "assumed"
) -> None:
    """Refuse values that fit no declaration about the world. Raises RulecError R0502 or R0503."""
    for name in values:
        declaration = vocabulary.declarations.get(name)
        if declaration is not None and declaration.parameters:
            why = f"`{given}` has `{name}`, which is about objects"
            raise UNFITTING_VALUE.error(None, why, help="assume only what is about none")
    check_state(values, {}, vocabulary, f"`{given}`")


def _without_unknown(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _plain(value) for name, value in values.items() if type(value) not in _NOT_TOLD}


def _plain(value: Any) -> Any:
    if isinstance(value, Interval):
        return value.middle
    return _without_unknown(value) if isinstance(value, Mapping) else value
