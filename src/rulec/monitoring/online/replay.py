"""Monitors of recorded traces, and of streams with unreadable states."""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.online.monitor_state import SoFar
from rulec.monitoring.online.running_monitor import Monitor
from rulec.monitoring.state_validation import check_objects, check_state
from rulec.trace import Trace
from rulec.trace.formats.live_states import LiveState
from rulec.trace.trace_validation import check_trace


def replay_trace(trace: Trace, rulebook: CompiledRulebook) -> Monitor:
    """A monitor behind the last state of a trace.

    Raises RulecError R0501 to R0508 if the trace does not fit the rulebook, as in ``verify``.
    """
    check_trace(trace)
    monitor = Monitor(rulebook, trace.step_s)
    check_objects(trace.objects, rulebook.vocabulary, trace.place)
    for number, state in enumerate(trace.states):
        check_state(state, trace.objects, rulebook.vocabulary, f"state {number}", trace.place)
        present = present_in(number, trace.objects, trace.present)
        restricted = {name: _restricted_to(present, value) for name, value in state.items()}
        monitor.step(restricted, present, trace.place)
    return monitor


def _restricted_to(objects: Container[str], value: Any) -> Any:
    """The values of the world and of these objects."""
    if not isinstance(value, Mapping):
        return value
    return {
        name: _restricted_to(objects, inner) for name, inner in value.items() if name in objects
    }


def answer(monitor: Monitor, item: LiveState | RulecError) -> SoFar | RulecError:
    """Take a step; an error is an answer too.

    ``item`` may be, in place of a state, the error that kept it from being read.
    """
    if isinstance(item, RulecError):
        return item
    try:
        return monitor.step(item.state, item.objects, item.place)
    except RulecError as error:
        return error
