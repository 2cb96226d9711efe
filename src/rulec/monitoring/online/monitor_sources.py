"""The sources of a monitor: recorded traces, saved monitors, streams."""

from __future__ import annotations

import json
from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import msgspec

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.diagnostic import with_place
from rulec.files.read_files import MAX_SAVED_BYTES, opened, read_whole
from rulec.files.written_files import refuse_unwritable, written_whole
from rulec.logic.codec import number_from_data
from rulec.monitoring.constant_values import with_constants
from rulec.monitoring.monitoring_messages import UNRESTORABLE_MONITOR
from rulec.monitoring.online.monitor_state import SoFar
from rulec.monitoring.online.running_monitor import RunningMonitor
from rulec.monitoring.state_validation import check_objects, check_state
from rulec.trace import Trace
from rulec.trace.formats.json_line_problems import is_beginning
from rulec.trace.formats.json_lines import LiveState
from rulec.trace.trace_model import check_trace, present_in


def replay_trace(trace: Trace, rulebook: CompiledRulebook) -> RunningMonitor:
    """A monitor after the last state of a trace.

    Raises RulecError R0501 to R0508 if the trace does not fit the rulebook, as in ``verify``.
    """
    check_trace(trace)
    monitor = RunningMonitor(rulebook, trace.step_s, told=trace.told)
    check_objects(trace.objects, rulebook.vocabulary, trace.place)
    for number, state in enumerate(trace.states):
        check_state(state, trace.objects, rulebook.vocabulary, f"state {number}", trace.place)
    # A constant may be given later than in the first state
    for number, state in enumerate(with_constants(trace, rulebook.vocabulary).states):
        present = present_in(number, trace.objects, trace.present)
        restricted = {name: _restricted_to(present, value) for name, value in state.items()}
        monitor.step(restricted, present, trace.place)
    return monitor


def _restricted_to(objects: Container[str], value: Any) -> Any:
    if not isinstance(value, Mapping):
        return value
    return {
        name: _restricted_to(objects, inner) for name, inner in value.items() if name in objects
    }


def answer(monitor: RunningMonitor, item: LiveState | RulecError) -> SoFar | RulecError:
    """Take a step and return the verdict, or the error that prevented it.

    In place of a state, ``item`` may be the error that prevented reading one.
    """
    if isinstance(item, RulecError):
        return item
    try:
        return monitor.step(item.state, item.objects, item.place)
    except RulecError as error:
        return with_place(error, item.place)


def read_saved(path: Path) -> Any:
    """Read a file for ``RunningMonitor.restore``. Raises RulecError R0701 or R0510."""
    with opened(path) as stream:
        return saved_from(read_whole(stream, path, MAX_SAVED_BYTES), str(path))


def saved_from(data: bytes, name: str) -> Any:
    """The content of a saved monitor's file with this name. Raises RulecError R0510."""
    try:
        # Unlike `json` it accepts neither NaN nor half a surrogate pair.
        return msgspec.json.decode(data)
    except (ValueError, RecursionError):
        why = "it has been cut short" if is_beginning(data) else "it is not JSON"
        message = f"this is not a saved monitor: {why}"
        help_text = "give a file that `rulec monitor --save` has written"
        raise UNRESTORABLE_MONITOR.error(SourceLocation(name), message, help=help_text) from None


def step_of(saved: Any) -> Fraction | None:
    """The step (s) of a saved monitor; None if it is missing or invalid."""
    try:
        step_s = number_from_data(saved["step_s"])
    except (TypeError, LookupError, ValueError):
        return None
    return step_s if step_s > 0 else None


@contextmanager
def saved_at_the_end(monitor: RunningMonitor, path: Path | None) -> Iterator[None]:
    """Save a monitor at the block's end, also if it raises an error.

    Until then a file that is there stays as it is. Without a path this does nothing. Raises
    RulecError R0702 or R0730, already at the beginning if the file cannot be written.
    """
    if path is not None:
        refuse_unwritable(path)
    try:
        yield
    finally:
        if path is not None:
            with written_whole(path) as stream:
                stream.write(json.dumps(monitor.snapshot(), ensure_ascii=False).encode() + b"\n")
