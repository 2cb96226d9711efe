"""A stored session of typing: each key, when it was pressed, and the text behind it.

A line of the file is an event, ``wait`` ms after the one before. ``go`` puts the cursor before the
first place with these words, ``type`` and ``paste`` write there, ``back`` takes away so many
letters before it, ``delete`` those behind it, as one key on what is selected does.

The session was written by a model of a typist, not by a person: slips of neighbouring, missing,
doubled and swapped letters that are noticed after up to three more, pauses at the ends of words and
lines, a rule pasted, changed, cut and put back, a name changed under what uses it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

SESSION = Path(__file__).with_name("session_de.jsonl")


def typed(text: str) -> Iterator[tuple[float, str]]:
    """For each key the pause before it, in seconds, and the text behind it."""
    at = waited = 0
    for line in SESSION.read_text(encoding="utf-8").splitlines():
        event = json.loads(line)
        waited += event["wait"]
        if "go" in event:
            at = text.index(event["go"])
            continue
        written = event.get("type", "") + event.get("paste", "")
        begin, end = at - event.get("back", 0), at + event.get("delete", 0)
        text, at = text[:begin] + written + text[end:], begin + len(written)
        yield waited / 1000, text
        waited = 0
