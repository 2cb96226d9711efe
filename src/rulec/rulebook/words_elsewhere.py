"""Undeclared words found in other rulebooks and vocabularies.

Texts are searched, not parsed, and only once there is a mistake to mend.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.ways_out import in_header
from rulec.rulebook.files.search_path import rulebook_texts
from rulec.rulebook.files.words_in_files import words_of_vocabularies
from rulec.rulebook.names.atom_messages import UNKNOWN_NAME

_SHORTEST = 3
"""Shorter names are variables and the like, and occur everywhere."""

_DEFINITION = re.compile(r"^\s*define\s+(\w+)", re.M)


def with_words_elsewhere(
    findings: Iterable[Diagnostic], read: Sequence[str], search_path: Sequence[Path] = ()
) -> tuple[Diagnostic, ...]:
    """Findings that say for unknown names which rulebooks or vocabularies have them.

    ``read`` are the rulebooks and vocabularies whose words are available already.
    """
    known = tuple(findings)
    names = [_unknown_name(finding) for finding in known]
    if not any(names):
        return known
    # Each file is read once, however many names are unknown.
    words = words_of_vocabularies(search_path)
    definitions = {path.stem: _defined_in(text) for path, text in rulebook_texts(search_path)}

    def with_way_out(finding: Diagnostic, name: str) -> Diagnostic:
        for vocabulary, own in words.items():
            if vocabulary not in read and name in own:
                use = f"use {vocabulary}"
                way_out = f"it is a word of the vocabulary `{vocabulary}`: `{use}`"
                file = finding.place.file if finding.place else ""
                return replace(finding, help=way_out, offers=(in_header(use, file),))
        for book, own in definitions.items():
            if book not in read and name in own:
                way_out = f"it is defined in the rulebook `{book}`: `extends {book}`, or copy it"
                return replace(finding, help=way_out, offers=())
        return finding

    return tuple(
        with_way_out(finding, name) if name else finding
        for finding, name in zip(known, names, strict=True)
    )


def _unknown_name(finding: Diagnostic) -> str:
    """The unknown name in a finding; empty if it is about something else, or misspelt."""
    place = finding.place
    if finding.code != UNKNOWN_NAME.code or place is None or place.column is None:
        return ""
    name = place.excerpt[place.column - 1 : (place.end_column or place.column) - 1].split("(")[0]
    offered = {fix.text.casefold() for offer in finding.offers for fix in offer.fixes}
    is_spelt_otherwise = name.casefold() in offered
    if not name.isidentifier() or len(name) < _SHORTEST or is_spelt_otherwise:
        return ""
    return name


@lru_cache(maxsize=128)
def _defined_in(text: str) -> frozenset[str]:
    return frozenset(_DEFINITION.findall(text))
