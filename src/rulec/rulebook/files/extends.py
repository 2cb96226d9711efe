"""The rulebooks that a rulebook extends, read from their files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError
from rulec.rulebook.arithmetic.size_messages import FORMULA_TOO_LARGE
from rulec.rulebook.files.reference_messages import (
    extends_circle,
    vocabulary_for_rulebook,
)
from rulec.rulebook.files.search_path import Dependency, find_base, is_same_file, read_bytes
from rulec.rulebook.rulebook_model import SourceFile
from rulec.syntax import decode, parse, tree

MOST_BASES = 50
"""Far more than any family of laws has."""


@dataclass(frozen=True, slots=True)
class Book:
    """Syntax tree of a rulebook, with its path or None."""

    file: tree.File
    path: Path | None


@dataclass(slots=True)
class Bases:
    """Rulebooks that one extends, most general first, with their mistakes.

    ``failed``: one of them could not be read.
    """

    books: list[Book] = field(default_factory=list)
    sources: list[SourceFile] = field(default_factory=list)
    mistakes: list[Diagnostic] = field(default_factory=list)
    dependencies: list[Dependency] = field(default_factory=list)
    failed: bool = False


def read_bases(file: tree.File, path: Path | None, search_path: Sequence[Path]) -> Bases:
    """Follow the ``extends`` lines up to a rulebook that extends no other."""
    bases = Bases()
    here = Book(file, path)
    way = [here]
    while here.file.extends is not None:
        line = here.file.extends
        try:
            above = find_base(line.name.text, line.name.span, here.path, search_path)
            first = next((book for book in way if _is(book, above)), None)
            if first is not None or len(way) > MOST_BASES:
                wrong = (
                    _too_many(line)
                    if first is None
                    else extends_circle(line, [book.file for book in way])
                )
                bases.mistakes.append(wrong)
                bases.failed = True
                break
            data = read_bytes(above, line.name.span)
            source = decode(str(above), data)
        except RulecError as error:
            bases.mistakes += error.diagnostics
            bases.failed = True
            break
        parsed, mistakes = parse(source)
        if parsed.kind == "vocabulary" and parsed.name is not None:
            bases.mistakes.append(
                vocabulary_for_rulebook(line.name, expected="expected the name of a rulebook")
            )
            bases.failed = True
            break
        bases.mistakes += mistakes
        record = source_file(above.name, data)
        bases.sources.append(record)
        user = str(here.path or "")
        needed = Dependency("base", line.name.text, user, str(above), record.sha256)
        bases.dependencies.append(needed)
        here = Book(parsed, above)
        way.append(here)
        bases.books.insert(0, here)
    return bases


def _is(book: Book, path: Path) -> bool:
    return book.path is not None and is_same_file(book.path, path)


def source_file(name: str, data: bytes) -> SourceFile:
    """A file for the record, by its base name and its content."""
    # A file's name may be no text at all; what goes into a compiled rulebook has to be.
    text = Path(name).name.encode("utf-8", "backslashreplace").decode()
    return SourceFile(text, sha256(data).hexdigest())


def _too_many(line: tree.ExtendsLine) -> Diagnostic:
    return FORMULA_TOO_LARGE.at(
        line.span,
        f"more than {MOST_BASES} rulebooks build upon one another",
        help="let a rulebook extend a more general one directly",
    )
