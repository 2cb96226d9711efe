"""Words that occur in the texts of vocabularies, which are searched and not parsed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files import search_path as search

_COMMENT = re.compile(rb"#[^\n]*")


def vocabularies_with(name: str, search_path: Sequence[Path] = ()) -> list[str]:
    """The vocabularies in which a word occurs outside comments."""
    word = re.compile(rf"\b{re.escape(name)}\b".encode())
    found = []
    for path in search.available_vocabularies(search_path):
        with suppress(RulecError):
            if word.search(_COMMENT.sub(b"", search.read_bytes(path))):
                found.append(path.stem)
    return found
