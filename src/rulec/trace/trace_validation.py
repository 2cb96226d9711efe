"""Conditions on every trace, whatever its vocabulary."""

from __future__ import annotations

import math
from collections.abc import Mapping

from rulec.trace.trace_messages import NO_STATES, NOT_A_TRACE, UNKNOWN_OBJECT
from rulec.trace.trace_model import Trace


def check_trace(trace: Trace) -> None:
    """Check states, step, and presence. Raises R0501, R0505, R0506."""
    check_frame(trace)
    for number, state in enumerate(trace.states):
        # Asking for a mapping takes far longer than asking for a dictionary.
        if type(state) is not dict and not isinstance(state, Mapping):
            raise NOT_A_TRACE.error(trace.place, f"state {number} is no object of names and values")
    check_presence(trace)


def check_frame(trace: Trace) -> None:
    """Check all of a trace but states and presence."""
    if not trace.states:
        raise NO_STATES.error(
            trace.place, "the trace has no states; it needs at least one to judge"
        )
    if not 0 < trace.step_s < math.inf:
        message = f"`step_s` is {float(trace.step_s):g}; it has to be a number of seconds above 0"
        raise NOT_A_TRACE.error(trace.place, message)


def check_presence(trace: Trace) -> None:
    """Check the presence of a trace's objects."""
    for name, (first, last) in trace.present.items():
        if name not in trace.objects:
            message = f"`present` speaks of `{name}`, which is not among the trace's objects"
            raise UNKNOWN_OBJECT.error(trace.place, message)
        if not 0 <= first <= last < len(trace.states):
            message = (
                f"`present` has `{name}` in states {first} to {last}; "
                f"the trace has states 0 to {len(trace.states) - 1}"
            )
            raise UNKNOWN_OBJECT.error(trace.place, message)
