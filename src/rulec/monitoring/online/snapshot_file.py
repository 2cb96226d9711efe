"""Files of saved monitors."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

from rulec.diagnostics import SourceLocation
from rulec.files import opened, written_whole
from rulec.monitoring.monitoring_messages import UNRESTORABLE_MONITOR
from rulec.monitoring.online.running_monitor import Monitor
from rulec.trace.formats.json_line_problems import is_beginning


def read_saved(path: Path) -> Any:
    """Read a file for ``Monitor.restore``. Raises RulecError R0701 or R0510."""
    with opened(path) as stream:
        data = stream.read()
    try:
        return json.loads(data)
    except (ValueError, RecursionError):
        why = "it has been cut short" if is_beginning(data) else "it is not JSON"
        message = f"this is not a saved monitor: {why}"
        help_text = "give a file that `rulec monitor --save` has written"
        raise UNRESTORABLE_MONITOR.error(
            SourceLocation(str(path)), message, help=help_text
        ) from None


def step_of(saved: Any) -> Fraction | None:
    """Step (s) of a saved monitor; None if missing or invalid."""
    try:
        step_s = Fraction(saved["step_s"])
    except (TypeError, LookupError, ValueError, ZeroDivisionError):
        return None
    return step_s if step_s > 0 else None


@contextmanager
def saved_at_the_end(monitor: Monitor, path: Path | None) -> Iterator[None]:
    """Save a monitor at the block's beginning and end, even on errors.

    Without a path this does nothing. Raises RulecError R0702.
    """
    _save(monitor, path)
    try:
        yield
    finally:
        _save(monitor, path)


def _save(monitor: Monitor, path: Path | None) -> None:
    if path is not None:
        with written_whole(path) as stream:
            stream.write(json.dumps(monitor.snapshot(), ensure_ascii=False).encode() + b"\n")
