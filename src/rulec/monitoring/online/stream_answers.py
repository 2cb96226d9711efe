"""Answers of a monitor to a stream with unreadable states."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.monitoring.online.monitor_state import SoFar
from rulec.monitoring.online.running_monitor import Monitor
from rulec.trace.formats.live_states import LiveState


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
