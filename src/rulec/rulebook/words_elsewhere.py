"""Where a word that nothing is called here is declared or defined: other books and vocabularies.

Texts are searched, not parsed, and only once there is a mistake to mend.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError
from rulec.rulebook.files import search_path as search
from rulec.rulebook.files.words_in_files import vocabularies_with
from rulec.rulebook.names.atom_messages import UNKNOWN_NAME

_SHORTEST = 3
"""Shorter names are variables and the like, and occur everywhere."""


def with_words_elsewhere(
    findings: Iterable[Diagnostic], read: Sequence[str], search_path: Sequence[Path] = ()
) -> tuple[Diagnostic, ...]:
    """Findings that say of unknown names in which rulebook or vocabulary these are.

    ``read`` are the rulebooks and vocabularies whose words there are already.
    """
    return tuple(_mended(finding, read, search_path) for finding in findings)


def _mended(finding: Diagnostic, read: Sequence[str], search_path: Sequence[Path]) -> Diagnostic:
    place = finding.place
    if finding.code != UNKNOWN_NAME.code or place is None or place.column is None:
        return finding
    name = place.excerpt[place.column - 1 : (place.end_column or place.column) - 1].split("(")[0]
    is_spelt_otherwise = f"did you mean `{name.casefold()}`" in finding.help.casefold()
    if not name.isidentifier() or len(name) < _SHORTEST or is_spelt_otherwise:
        return finding
    if own := [book for book in vocabularies_with(name, search_path) if book not in read]:
        return replace(finding, help=f"it is a word of the vocabulary `{own[0]}`: `use {own[0]}`")
    for book in search.available_rulebooks(search_path):
        if book not in read and _defines(book, name, search_path):
            way_out = f"it is defined in the rulebook `{book}`: `extends {book}`, or copy it"
            return replace(finding, help=way_out)
    return finding


def _defines(book: str, name: str, search_path: Sequence[Path]) -> bool:
    definition = re.compile(rf"^\s*define\s+{re.escape(name)}\b".encode(), re.M)
    with suppress(RulecError):
        path = search.find_rulebook(book, search_path)
        return definition.search(search.read_bytes(path)) is not None
    return False
