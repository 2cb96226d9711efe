"""What is assumed of traces where they do not tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from rulec.diagnostics import RulecError
from rulec.trace import Trace, Value
from rulec.trace.trace_model import Ending
from rulec.vocabulary.partial_values import UNKNOWN, Interval


@dataclass(frozen=True, slots=True)
class Assumptions:
    """How traces end, and values of what is unknown in them.

    ``values`` are of names that are about no object. With ``defaults`` all else that is unknown has
    its default, a number within bounds is their middle, and the end of a trace is the end of what
    happened, unless ``ends`` says otherwise.
    """

    ends: Ending | None = None
    values: Mapping[str, Value] = field(default_factory=dict)
    defaults: bool = False

    def __bool__(self) -> bool:
        return self.ends is not None or bool(self.values) or self.defaults

    def applied(self, trace: Trace) -> Trace:
        """The trace with these assumptions; what it tells stays."""
        told = trace.told
        untold = {} if told is None else {k: v for k, v in self.values.items() if k not in told}
        states = trace.states
        if self.values or self.defaults:
            states = tuple(
                {**untold, **self._told(state)} if isinstance(state, Mapping) else state
                for state in states
            )
        ends = self.ends or ("complete" if self.defaults else trace.ends)
        if self.defaults:
            told = None
        elif told is not None:
            told = told.union(untold)
        return replace(trace, states=states, ends=ends, told=told)

    def of(self, traces: Sequence[Trace | RulecError]) -> Sequence[Trace | RulecError]:
        """Traces with these assumptions; without any the same sequence."""
        if not self:
            return traces
        return [self.applied(item) if isinstance(item, Trace) else item for item in traces]

    def _told(self, state: Mapping[str, Any]) -> dict[str, Any]:
        values = self.values
        known = {
            name: values[name] if value is UNKNOWN and name in values else value
            for name, value in state.items()
        }
        return _without_unknown(known) if self.defaults else known


def _without_unknown(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _plain(value) for name, value in values.items() if value is not UNKNOWN}


def _plain(value: Any) -> Any:
    if isinstance(value, Interval):
        return value.middle
    return _without_unknown(value) if isinstance(value, Mapping) else value
