"""Error for questions that are too large or not supported."""

from __future__ import annotations


class UndecidedError(Exception):
    """The question is left open; the text says why, as a clause."""
