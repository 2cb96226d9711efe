"""Rulebooks of one name under names by which they are distinct."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rulec.rulebook.files.edition_names import edition_names
from rulec.rulebook.rulebook_model import Rulebook


def with_distinct_names(books: Sequence[Rulebook]) -> list[Rulebook]:
    """The rulebooks, those of one name with their files, or else numbers, after it."""
    names = edition_names([book.name for book in books], [_own_file(book) for book in books])
    return [
        book if book.name == name else replace(book, name=name)
        for book, name in zip(books, names, strict=True)
    ]


def _own_file(book: Rulebook) -> str:
    """The file of a rule that the rulebook has of its own; empty if there is none."""
    spans = (rule.span for rule in book.rules if rule.book == book.name)
    return next((span.source.name for span in spans if span is not None), "")
