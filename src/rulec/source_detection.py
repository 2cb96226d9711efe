"""Detection of the language's sources by their first words."""

from __future__ import annotations

import codecs
import re
from typing import Final

FILE_WORDS: Final = ("rulebook", "vocabulary")
"""The word that a source begins with, comments aside."""

LEAD_BYTES: Final = 65536
"""So much of a file is looked at; longer comments are no beginning."""

_LEAD = re.compile(r"(?:\s+|#[^\n\r]*)*(\w*)")
_ALIKE = 0.8
"""Share of letters in common: `rulbook` is meant for `rulebook`, `rule` and `notebook` are not."""


def is_foreign(text: str) -> bool:
    """True for a text that begins like no source. One that is empty, or misspelt, is none."""
    start, end = first_word_at(text)
    word = text[start:end]
    if word in FILE_WORDS or start == len(text):
        return False
    # 4 ms, and seldom needed.
    from difflib import get_close_matches

    return not get_close_matches(word.casefold()[:40], FILE_WORDS, n=1, cutoff=_ALIKE)


def beginning_of(data: bytes) -> str:
    """The beginning of a file as text, whatever is behind it."""
    is_utf16 = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return data[:LEAD_BYTES].decode("utf-16" if is_utf16 else "utf-8-sig", "replace")


def first_word_at(text: str) -> tuple[int, int]:
    """Start and end of the first word of a text, comments aside; equal if it begins with none."""
    lead = _LEAD.match(text)
    assert lead is not None, "the pattern matches nothing, too"
    return lead.span(1)
