"""Reads the rulebooks that one extends and the vocabularies that they use."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from rulec.diagnostics import Diagnostic, Label, RulecError, Source
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import line_left_out, line_of, offering, write
from rulec.rulebook.arithmetic.size_limits import TOO_LONG
from rulec.rulebook.files import search_path as search
from rulec.rulebook.rulebook_model import SourceFile
from rulec.syntax import decode, tree
from rulec.syntax.caching.tree_cache import parsed

if TYPE_CHECKING:  # a check that is recalled does not load the parser
    from rulec.syntax import tree

WRONG_KIND_OF_FILE = Code(
    "R0206",
    title="a file has another kind or name than expected",
    why="A rulebook has rules and can be compiled; a vocabulary has declarations and can be used. "
    "A vocabulary `NAME` is found in a file `NAME.rules` that begins with `vocabulary NAME`.",
    bad="echo 'vocabulary town { signal fog }' > town.rules\nrulec compile ./town.rules -o build",
    good="echo 'vocabulary town { signal fog }' > town.rules\n"
    "echo 'rulebook city use town hard rule r { require never fog }' > city.rules\n"
    "rulec compile ./city.rules -o build",
    kind="command",
)

EXTENDS_CIRCLE = Code(
    "R0213",
    title="rulebooks extend each other in a circle",
    why="Each rulebook builds upon a more general one, up to one that extends no other. A cycle "
    "is not possible.",
    bad="printf 'rulebook a\\nextends b\\n' > a.rules\n"
    "printf 'rulebook b\\nextends a\\n' > b.rules\nrulec check a.rules\n",
    good="printf 'rulebook a\\nextends b\\n' > a.rules\n"
    "printf 'rulebook b\\nsignal p\\nhard rule r { require always p }\\n' > b.rules\n"
    "rulec check a.rules\n",
    kind="command",
)


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
                raise RulecError(_extends_circle(line, [link.file for link in chain[place:]]))
        if len(chain) > MOST_BASES:
            raise _too_long_a_chain(line, [link.file for link in chain])
        data = self._read("base", name, user, path)
        file, mistakes = _parsed(decode(str(path), data))
        if file.kind == "vocabulary" and file.name is not None:
            expected = "expected the name of a rulebook"
            raise RulecError(vocabulary_for_rulebook(name, expected=expected))
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
                raise RulecError(_not_the_vocabulary(use, file, path))
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


def _extends_circle(line: tree.ExtendsLine, way: Sequence[tree.File]) -> Diagnostic:
    names = [f"`{file.name.text}`" if file.name else "a rulebook" for file in way]
    chain = " extends ".join([*names, f"`{line.name.text}`"])
    before = [file.extends for file in way if file.extends is not None and file.extends != line]
    return EXTENDS_CIRCLE.at(
        line.name.span,
        f"the rulebooks go round in a circle: {chain}",
        expected="this closes the circle",
        help=offering(
            "the most general of them extends no other: leave its `extends` line out",
            *line_left_out(line.name.span, "extends"),
        ),
        labels=tuple(
            Label(extends.span.place, f"`{extends.name.text}` is extended here")
            for extends in before
        ),
    )


def _not_the_vocabulary(use: tree.UseLine, file: tree.File, path: Path) -> Diagnostic:
    assert file.name is not None, "only files with a name have another one"
    if file.kind == "rulebook":
        message = f"`{path.name}` is a rulebook, not a vocabulary"
    else:
        message = f"`{path.name}` holds another vocabulary, `{file.name.text}`"
    return WRONG_KIND_OF_FILE.at(
        use.name.span,
        message,
        expected="expected the name of a vocabulary",
        help=f"give the vocabulary a file of its own that begins with `vocabulary {use.name.text}`",
    )


def vocabulary_for_rulebook(name: tree.Name, *, expected: str) -> Diagnostic:
    """A vocabulary where a rulebook is asked for."""
    use = f"use {name.text}"
    used = (write(f"{use}\n", line) for line in line_of(name.span, "extends"))
    return WRONG_KIND_OF_FILE.at(
        name.span,
        f"`{name.text}` is a vocabulary, not a rulebook",
        expected=expected,
        help=offering(f"a rulebook takes its words from it by `{use}`", *used),
    )
