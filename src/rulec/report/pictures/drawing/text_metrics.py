"""The room that text takes, whatever the fixed-width font."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

CHARACTER = 7.3
"""The width of a character in px, a little more than that of the usual fixed-width fonts."""


def text_width(lines: Sequence[str]) -> float:
    """The width of the widest line in px."""
    return max((sum(map(_columns, line)) for line in lines), default=0) * CHARACTER


def _columns(character: str) -> int:
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
