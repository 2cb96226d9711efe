"""Recognising the language's sources by their first words."""

from __future__ import annotations

import codecs
import re
from typing import Final

from rulec.diagnostics import nearest_name

FILE_WORDS: Final = ("rulebook", "vocabulary")
"""The words with which a source begins, after comments."""

LEAD_BYTES: Final = 65536
"""The number of bytes examined; longer comments hide the beginning."""

_LEAD = re.compile(r"(?:\s+|#[^\n\r]*)*(\w*)")
_ALIKE = 0.8
"""Similarity from which a word counts as misspelt: `rulbook` does, `rule` and `notebook` do not."""


def is_foreign(text: str) -> bool:
    """Whether a text begins unlike any source; False if empty or with a misspelt first word."""
    start, end = first_word_at(text)
    word = text[start:end]
    if word in FILE_WORDS or start == len(text):
        return False
    return nearest_name(word[:40], FILE_WORDS, _ALIKE, longer=False) is None


def beginning_of(data: bytes) -> str:
    """The beginning of a file as text, up to ``LEAD_BYTES``."""
    is_utf16 = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return data[:LEAD_BYTES].decode("utf-16" if is_utf16 else "utf-8-sig", "replace")


def first_word_at(text: str) -> tuple[int, int]:
    """Start and end of the first word of a text, after comments; equal if there is none."""
    lead = _LEAD.match(text)
    assert lead is not None, "the pattern matches nothing, too"
    return lead.span(1)
