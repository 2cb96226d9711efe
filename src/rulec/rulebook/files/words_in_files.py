"""Words that occur in the texts of vocabularies, which are searched and not parsed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files import search_path as search

_COMMENT = re.compile(r"#[^\n]*")


def words_of_vocabularies(search_path: Sequence[Path] = ()) -> dict[str, frozenset[str]]:
    """The words that occur in each vocabulary outside comments."""
    found = {}
    for path in search.available_vocabularies(search_path):
        with suppress(RulecError):
            text = search.read_bytes(path).decode(errors="replace")
            found[path.stem] = frozenset(re.findall(r"\w+", _COMMENT.sub("", text)))
    return found


def vocabularies_with(name: str, search_path: Sequence[Path] = ()) -> list[str]:
    """The vocabularies in which a word occurs outside comments."""
    return [one for one, words in words_of_vocabularies(search_path).items() if name in words]
