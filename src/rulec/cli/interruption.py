"""Ctrl-C, remembered: whatever becomes of it on its way up, the program was interrupted.

Libraries turn an interrupt into errors of their own while they are imported, such as ImportError.
"""

from __future__ import annotations

import signal
from types import FrameType

_seen: list[int] = []


def interrupt(number: int, frame: FrameType | None) -> None:
    """Handle a signal as Python does. Raises KeyboardInterrupt."""
    _seen.append(number)
    signal.default_int_handler(number, frame)


def is_interrupted() -> bool:
    """True if there was such a signal."""
    return bool(_seen)
