"""Tracks that are cut: their parts are judged as different participants."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.recordings.encodings.xml_element import short

_NAMED = 3


def cut_remark(names: Sequence[str], why: str) -> str:
    """A remark on the tracks that were cut, by their ids; ``why`` names the places."""
    what = "1 track is cut" if len(names) == 1 else f"{len(names):,} tracks are cut"
    return f"{what} at {why}, and what follows is another road user: {first_ids(names)}"


def first_ids(names: Sequence[str]) -> str:
    """The first of some tracks' ids, and how many more there are."""
    some = ", ".join(f"`{short(name)}`" for name in names[:_NAMED])
    return f"{some}, and {len(names) - _NAMED} more" if len(names) > _NAMED else some
