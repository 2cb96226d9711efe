"""Remembers Ctrl-C: the program was interrupted, whatever happens to the exception.

Libraries turn an interrupt during their import into errors of their own, such as ImportError.
"""

from __future__ import annotations

import signal
from types import FrameType

_seen: list[int] = []


def interrupt(number: int, frame: FrameType | None) -> None:
    """Handle a signal like Python. Raises KeyboardInterrupt."""
    _seen.append(number)
    signal.default_int_handler(number, frame)


def is_interrupted() -> bool:
    """Whether there was such a signal."""
    return bool(_seen)
