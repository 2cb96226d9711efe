"""Tracks that are cut: their parts are judged as different participants."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.recordings.encodings.xml_element import short

_NAMED = 3


def cut_remark(names: Sequence[str], why: str) -> str:
    """A remark on the tracks that were cut, by their ids; ``why`` names the places."""
    some = ", ".join(f"`{short(name)}`" for name in names[:_NAMED])
    more = f", and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    what = "1 track is cut" if len(names) == 1 else f"{len(names):,} tracks are cut"
    return f"{what} at {why}, and what follows is another road user: {some}{more}"
