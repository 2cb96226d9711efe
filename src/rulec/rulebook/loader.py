"""Rulebooks from files and from text: read, resolved, with all that is wrong in one error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, Source, Span
from rulec.rulebook.files.extends import Book, read_bases, source_file
from rulec.rulebook.files.reference_messages import WRONG_KIND_OF_FILE
from rulec.rulebook.files.search_path import (
    Dependency,
    available_rulebooks,
    find_rulebook,
    read_bytes,
)
from rulec.rulebook.files.vocabulary_files import Vocabularies
from rulec.rulebook.model import Rulebook, Traffic
from rulec.rulebook.resolve import resolve, resolve_vocabulary
from rulec.syntax import decode, parse, tree
from rulec.vocabulary import Vocabulary

__all__ = [
    "Diagnosis",
    "Loaded",
    "available_rulebooks",
    "diagnose",
    "load_rulebook",
    "load_vocabulary",
    "parse_rulebook",
    "read_rulebook",
]


@dataclass(frozen=True, slots=True)
class Loaded:
    """A rulebook without errors, the warnings about it, and the trees that it comes from.

    ``books`` are those that it extends, the most general first, and itself; ``vocabularies`` those
    that they use.
    """

    rulebook: Rulebook
    warnings: tuple[Diagnostic, ...] = ()
    books: tuple[tree.File, ...] = field(default=(), compare=False, repr=False)
    vocabularies: tuple[tree.File, ...] = field(default=(), compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """All that there is to say about a file.

    ``dependencies`` are the other files that it depends on; None if one of them is missing, so that
    any new file could make a difference.
    """

    findings: tuple[Diagnostic, ...]
    dependencies: tuple[Dependency, ...] | None = ()


def load_rulebook(
    reference: str | Path, search_path: Sequence[str | Path] = (), at: str = ""
) -> Rulebook:
    """A rulebook as meant.

    Args:
        reference: a name, looked for as NAME.rules and NAME/NAME.rules in the folders of
            ``search_path`` and then among the rulebooks that ship with rulec; or a path, which
            contains a ``/`` or ends in ``.rules``.
        search_path: folders of rulebooks and vocabularies.
        at: the day (ISO) whose law it is; if empty, that of its `law` line or else today.

    Raises:
        RulecError: with every mistake in the rulebook, in those that it extends, and in the
            vocabularies that they use.
    """
    return read_rulebook(reference, search_path, at).rulebook


def read_rulebook(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    traffic: Traffic = "",
) -> Loaded:
    """As ``load_rulebook``, with the warnings.

    ``traffic``: read it as one for this side, whatever it says itself.
    """
    folders = [Path(folder) for folder in search_path]
    path = find_rulebook(reference, folders)
    data = read_bytes(path)
    return _load(decode(str(path), data), data, path, folders, at, traffic)


def parse_rulebook(
    text: str, name: str = "<text>", search_path: Sequence[Path] = (), at: str = ""
) -> Rulebook:
    """A rulebook whose text is at hand; messages call it ``name``.

    Raises:
        RulecError: with every mistake in it and in the vocabularies that it uses.
    """
    data = text.encode("utf-8", "surrogatepass")
    return _load(Source(name, text), data, None, search_path, at).rulebook


def load_vocabulary(name: str, search_path: Sequence[Path] = ()) -> Vocabulary:
    """A vocabulary by its name.

    Raises:
        RulecError: it is not found, or with every mistake in it.
    """
    asked = Source("<vocabulary>", name)
    found = Vocabularies(tuple(search_path))
    use = tree.UseLine(tree.Name(name, Span(asked, 0, len(name))))
    file = found.read(use, None)
    if file is None or found.mistakes:
        raise RulecError(found.mistakes)
    vocabulary, mistakes = resolve_vocabulary(file)
    if vocabulary is None:
        raise RulecError(mistakes)
    return vocabulary


def diagnose(
    name: str,
    data: bytes,
    path: Path | None = None,
    search_path: Sequence[Path] = (),
    at: str = "",
) -> Diagnosis:
    """Everything that there is to say about a rulebook or a vocabulary, errors and warnings.

    Args:
        name: what messages call it.
        data: its content.
        path: where it is, so that vocabularies beside it are found; None if that is nowhere.
        search_path: folders of rulebooks and vocabularies.
        at: the day (ISO) whose law it is; if empty, that of its `law` line or else today.
    """
    try:
        source = decode(name, data)
        file, mistakes = parse(source)
        if file.kind == "rulebook":
            return _resolved(source, data, path, search_path, (file, mistakes), at)[1]
        _, meanings = resolve_vocabulary(file)
    except RulecError as error:
        return Diagnosis(error.diagnostics)
    return Diagnosis(_in_order(name, [*mistakes, *meanings]))


def _load(
    source: Source,
    data: bytes,
    path: Path | None,
    search_path: Sequence[Path],
    at: str,
    traffic: Traffic = "",
) -> Loaded:
    file, mistakes = parse(source)
    if file.kind == "vocabulary" and file.name is not None:
        raise RulecError(_not_a_rulebook(file))
    loaded, diagnosis = _resolved(source, data, path, search_path, (file, mistakes), at, traffic)
    if loaded is None:
        raise RulecError(diagnosis.findings)
    return loaded


def _resolved(
    source: Source,
    data: bytes,
    path: Path | None,
    search_path: Sequence[Path],
    parsed: tuple[tree.File, tuple[Diagnostic, ...]],
    at: str,
    traffic: Traffic = "",
) -> tuple[Loaded | None, Diagnosis]:
    """The rulebook if it has no errors, and what there is to say about it."""
    file, mistakes = parsed
    based = read_bases(file, path, search_path)
    found = Vocabularies(tuple(search_path))
    books = [*based.books, Book(file, path)]
    trees = [found.read(use, book.path) for book in books for use in _once(book.file.uses)]
    vocabularies = tuple(one for one in trees if one is not None)
    opaque = found.failed or based.failed
    rulebook, meanings = resolve(
        file,
        vocabularies,
        bases=[book.file for book in based.books],
        sources=(source_file(source.name, data), *based.sources, *found.sources),
        opaque=opaque,
        at=at or (file.law.as_of if file.law else "") or date.today().isoformat(),  # noqa: DTZ011
        traffic=traffic,
    )
    everything = _in_order(source.name, [*mistakes, *based.mistakes, *found.mistakes, *meanings])
    needed = None if opaque else (*based.dependencies, *found.dependencies)
    diagnosis = Diagnosis(everything, needed)
    if rulebook is None or any(one.severity == "error" for one in everything):
        return None, diagnosis
    trees_of_books = tuple(book.file for book in books)
    return Loaded(rulebook, everything, trees_of_books, vocabularies), diagnosis


def _once(uses: Sequence[tree.UseLine]) -> list[tree.UseLine]:
    first: dict[str, tree.UseLine] = {}
    for use in uses:
        first.setdefault(use.name.text, use)
    return list(first.values())


def _in_order(main: str, mistakes: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The rulebook's own first, each file's from top to bottom."""

    def rank(one: Diagnostic) -> tuple[bool, str, tuple[int, int]]:
        place = one.place
        if place is None:
            return True, "", (0, 0)
        return place.file != main, place.file, place.start

    return tuple(sorted(mistakes, key=rank))


def _not_a_rulebook(file: tree.File) -> Diagnostic:
    assert file.name is not None, "only files with a name are known to be vocabularies"
    return WRONG_KIND_OF_FILE.at(
        file.name.span,
        f"`{file.name.text}` is a vocabulary, not a rulebook",
        expected="expected `rulebook NAME`",
        help=f"a rulebook takes its words from it by `use {file.name.text}`",
    )
