"""Replay of recorded traces: a monitor takes their states one by one."""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.online.running_monitor import Monitor
from rulec.monitoring.state_validation import check_objects, check_state
from rulec.trace import State, Trace
from rulec.trace.trace_validation import check_trace


def replay_trace(trace: Trace, rulebook: CompiledRulebook) -> Monitor:
    """A monitor behind the last state of a trace.

    Raises:
        RulecError: R0501 to R0508 if the trace does not fit the rulebook, as in ``verify``.
    """
    check_trace(trace)
    monitor = Monitor(rulebook, trace.step_s)
    check_objects(trace.objects, rulebook.vocabulary, trace.place)
    for number, state in enumerate(trace.states):
        check_state(state, trace.objects, rulebook.vocabulary, f"state {number}", trace.place)
        present = present_in(number, trace.objects, trace.present)
        monitor.step(_restricted_to(present, state), present, trace.place)
    return monitor


def _restricted_to(objects: Container[str], state: State) -> State:
    """The values of the world and of these objects."""
    return {name: _of(objects, value) for name, value in state.items()}


def _of(objects: Container[str], value: Any) -> Any:
    if not isinstance(value, Mapping):
        return value
    return {name: _of(objects, inner) for name, inner in value.items() if name in objects}
