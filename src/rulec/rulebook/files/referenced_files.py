"""Reads the rulebooks that one extends and the vocabularies that they use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Literal

from rulec.diagnostics import Diagnostic, Label, RulecError, Source
from rulec.rulebook.arithmetic.size_messages import TOO_LONG
from rulec.rulebook.files import reference_messages as say
from rulec.rulebook.files import search_path as search
from rulec.rulebook.rulebook_model import SourceFile
from rulec.syntax import decode, tree
from rulec.syntax.caching.tree_cache import parsed

MOST_BASES = 50
"""The most rulebooks that one builds upon, far more than any family of laws has."""


@dataclass(frozen=True, slots=True)
class Book:
    """The syntax tree of a rulebook, with its path or None."""

    file: tree.File
    path: Path | None


@lru_cache(maxsize=16)
def _parsed(source: Source) -> tuple[tree.File, tuple[Diagnostic, ...]]:
    """The cached result of ``parse``, since many rulebooks have the same bases."""
    return parsed(source)


def source_file(name: str, data: bytes) -> SourceFile:
    """A file for the record, by its base name and its content."""
    # A file's name may be no text at all; what goes into a compiled rulebook has to be.
    text = Path(name).name.encode("utf-8", "backslashreplace").decode()
    return SourceFile(text, sha256(data).hexdigest())


def _too_long_a_chain(line: tree.ExtendsLine, chain: Sequence[tree.File]) -> RulecError:
    """The error of the first rulebook of a chain; the last one's ``line`` is one too many."""
    first = chain[0].extends
    assert first is not None, "a chain has links"
    return TOO_LONG.error(
        first.span,
        f"this rulebook builds upon more than {MOST_BASES} rulebooks, one upon another",
        expected=f"expected no more than {MOST_BASES}",
        help="let it, or one between, extend a more general one directly, and state itself what "
        "those that it leaves out change",
        labels=(Label(line.span.place, f"this would be number {len(chain)}"),),
    )


@dataclass(slots=True)
class ReferencedFiles:
    """Reads the files that rulebooks refer to, recording them and their mistakes.

    ``failed``: one of them could not be read.
    """

    search_path: Sequence[Path]
    sources: list[SourceFile] = field(default_factory=list)
    mistakes: list[Diagnostic] = field(default_factory=list)
    dependencies: list[search.Dependency] = field(default_factory=list)
    failed: bool = False
    _vocabularies: list[Path] = field(default_factory=list, init=False)

    def bases(self, book: Book) -> list[Book]:
        """The rulebooks that one extends, the most general first."""
        chain = [book]
        try:
            while (line := chain[-1].file.extends) is not None:
                chain.append(self._base(line, chain))
        except RulecError as error:
            self._fail(error)
        return chain[:0:-1]

    def _base(self, line: tree.ExtendsLine, chain: Sequence[Book]) -> Book:
        name, user = line.name, chain[-1].path
        path = search.find_base(name.text, name.span, user, self.search_path)
        for place, book in enumerate(chain):
            if book.path is not None and search.is_same_file(book.path, path):
                raise RulecError(say.extends_circle(line, [link.file for link in chain[place:]]))
        if len(chain) > MOST_BASES:
            raise _too_long_a_chain(line, [link.file for link in chain])
        data = self._read("base", name, user, path)
        file, mistakes = _parsed(decode(str(path), data))
        if file.kind == "vocabulary" and file.name is not None:
            expected = "expected the name of a rulebook"
            raise RulecError(say.vocabulary_for_rulebook(name, expected=expected))
        self.mistakes += mistakes
        self.sources.append(source_file(path.name, data))
        return Book(file, path)

    def vocabulary(self, use: tree.UseLine, user: Path | None) -> tree.File | None:
        """The syntax tree of a vocabulary; None if it is unreadable or was read before."""
        name = use.name
        try:
            path = search.find_vocabulary(name.text, name.span, user, self.search_path)
            data = self._read("vocabulary", name, user, path)
            if any(search.is_same_file(path, known) for known in self._vocabularies):
                return None
            source = decode(str(path), data)
            self._vocabularies.append(path)
            file, mistakes = _parsed(source)
            if file.name is not None and (file.kind, file.name.text) != ("vocabulary", name.text):
                raise RulecError(say.not_the_vocabulary(use, file, path))
        except RulecError as error:
            self._fail(error)
            return None
        self.sources.append(source_file(path.name, data))
        self.mistakes += mistakes
        return file

    def _read(
        self, kind: Literal["base", "vocabulary"], name: tree.Name, user: Path | None, path: Path
    ) -> bytes:
        data = search.read_bytes(path, name.span)
        content = sha256(data).hexdigest()
        dependency = search.Dependency(kind, name.text, str(user or ""), str(path), content)
        self.dependencies.append(dependency)
        return data

    def _fail(self, error: RulecError) -> None:
        self.mistakes += error.diagnostics
        self.failed = True
