"""The nearest known name, for "did you mean"."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

_MOST = 500
"""Among more names the search takes too long; only those with the same letters are found then."""


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """The known name closest to ``name``, ignoring case, or None."""
    by_folded: dict[str, str] = {}
    for candidate in known:
        by_folded.setdefault(candidate.casefold(), candidate)
    same = by_folded.get(name.casefold())
    if same is not None or len(by_folded) > _MOST:
        return same
    close = get_close_matches(name.casefold(), list(by_folded), n=1, cutoff=0.6)
    return by_folded[close[0]] if close else None
