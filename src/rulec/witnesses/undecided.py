"""A question that is too large, or of a kind that is not answered."""

from __future__ import annotations


class UndecidedError(Exception):
    """The question is left open; the text says why, as a clause."""
