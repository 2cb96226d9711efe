"""Names by which rulebooks of one name are distinct, such as two editions of a book."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from os.path import commonpath
from pathlib import PurePath

from rulec.rulebook.rulebook_model import Rulebook


def with_distinct_names(books: Sequence[Rulebook]) -> list[Rulebook]:
    """The rulebooks, those of one name with their files, or else numbers, after it."""
    times = Counter(book.name for book in books)
    twins = [number for number, book in enumerate(books) if times[book.name] > 1]
    files = {number: _own_file(books[number]) for number in twins}
    texts = _short(files) if len(set(files.values())) == len(twins) else {}
    named = list(books)
    for place, number in enumerate(twins, 1):
        own = texts.get(number, str(place))
        named[number] = replace(books[number], name=f"{books[number].name} ({own})")
    return named


def _own_file(book: Rulebook) -> str:
    """The file of a rule that the rulebook has of its own; empty if there is none."""
    spans = (rule.span for rule in book.rules if rule.book == book.name)
    return next((span.source.name for span in spans if span is not None), "")


def _short(files: dict[int, str]) -> dict[int, str]:
    """The paths of files from their common folder on."""
    if not all(files.values()):
        return {}
    try:
        common = PurePath(commonpath(files.values()))
    except ValueError:  # some are absolute, others are not
        return files
    return {number: PurePath(file).relative_to(common).as_posix() for number, file in files.items()}
