"""Tracks that are cut, or have holes: their parts are judged by themselves."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import first_of
from rulec.recordings.encodings.file_values import short

_NAMED = 3


def cut_remark(names: Sequence[str], why: str) -> str:
    """A remark on the tracks that were cut, by their ids; ``why`` names the places."""
    what = "1 track is cut" if len(names) == 1 else f"{len(names):,} tracks are cut"
    return f"{what} at {why}, and what follows is another road user: {first_ids(names)}"


def missing_remark(names: Sequence[str], longest_s: float) -> str:
    """A remark on those who drive and are missing for more than ``longest_s``, by their ids."""
    who = "1 vehicle is" if len(names) == 1 else f"{len(names):,} vehicles are"
    return (
        f"{who} missing for more than {longest_s:g} s on the way, and what happens meanwhile is "
        f"not judged: {first_ids(names)}"
    )


def first_ids(names: Sequence[str]) -> str:
    """The first of some tracks' ids, and how many more there are."""
    return first_of([f"`{short(name)}`" for name in names], _NAMED)
