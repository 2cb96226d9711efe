"""Loads rulebooks from files and text, collecting all mistakes."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from datetime import date
from functools import lru_cache
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation, Span
from rulec.diagnostics.ways_out import in_header
from rulec.rulebook.allowances import judged_allowances
from rulec.rulebook.files import search_path as search
from rulec.rulebook.files.reference_messages import vocabulary_for_rulebook
from rulec.rulebook.files.referenced_files import Book, ReferencedFiles, source_file
from rulec.rulebook.files.search_path import rulebook_texts
from rulec.rulebook.files.words_in_files import words_of_vocabularies
from rulec.rulebook.names.atom_messages import UNKNOWN_NAME
from rulec.rulebook.overlay.rulebook_overlay import law_line
from rulec.rulebook.resolve import BookNames, Translate, resolve, resolve_vocabulary, translated
from rulec.rulebook.rulebook_model import Loaded, Rulebook, SourceFile, Traffic, provision_note
from rulec.syntax import decode, parse, tree
from rulec.syntax.caching.tree_cache import parsed
from rulec.syntax.messages.structure import UNBALANCED_BRACE
from rulec.vocabulary import Vocabulary


def with_provisions(
    findings: Iterable[Diagnostic],
    books: Sequence[tree.File],
) -> tuple[Diagnostic, ...]:
    """Findings; those within a rule get a note with what it cites.

    ``books`` are those that a rulebook extends, the most general first, and itself; an override
    that cites nothing has the provision of the overridden rule.
    """
    diagnostics = tuple(findings)
    if not diagnostics:
        return diagnostics
    cited: dict[str, str] = {}
    rules: dict[str, list[tuple[int, int, str]]] = {}
    for book in books:
        for item in book.items:
            if not isinstance(item, tree.RuleItem):
                continue
            if item.cite is not None:
                cited[item.name.text] = item.cite.value
            if provision := cited.get(item.name.text):
                place = item.span.place
                lines = (place.line or 0, place.end_line or 0)
                note = provision_note(item.name.text, provision)
                rules.setdefault(place.file, []).append((*lines, note))
    return tuple(_noted(finding, rules) for finding in diagnostics)


def _noted(finding: Diagnostic, rules: dict[str, list[tuple[int, int, str]]]) -> Diagnostic:
    place = finding.place
    if finding.code == UNBALANCED_BRACE.code and finding.labels:
        # It stands in the next rule, where something should have ended; its label is in this one.
        place = finding.labels[0].place
    if place is None or place.line is None:
        return finding
    within = rules.get(place.file, [])
    index = bisect_right(within, place.line, key=lambda entry: entry[0]) - 1
    if index < 0 or place.line > within[index][1]:
        return finding
    return replace(finding, notes=(*finding.notes, within[index][2]))


@dataclass(frozen=True, slots=True)
class RulebookFile:
    """The text of a rulebook with its path, if any, and search path."""

    source: Source
    data: bytes
    path: Path | None = None
    search_path: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class Trees:
    """The syntax trees of a rulebook and of its dependencies, with mistakes.

    ``books`` are those that it extends, the most general first, and itself. Without
    ``dependencies`` a file could not be read, so that any name may be missing for that reason.
    """

    name: str
    books: tuple[tree.File, ...]
    vocabularies: tuple[tree.File, ...]
    sources: tuple[SourceFile, ...]
    mistakes: tuple[Diagnostic, ...]
    dependencies: tuple[search.Dependency, ...] | None
    search_path: tuple[Path, ...] = ()


@dataclass(frozen=True, slots=True)
class ResolvedTrees:
    """Trees, the names their formulas can use, the rulebook if it has no error, all findings."""

    trees: Trees
    names: BookNames
    rulebook: Rulebook | None
    findings: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """All diagnostics about a file, and the other files that it depends on.

    The dependencies are unknown if one is missing, since any new file could make a difference.
    """

    findings: tuple[Diagnostic, ...]
    dependencies: tuple[search.Dependency, ...] | None = ()


def read_trees(reference: str | Path, search_path: Sequence[str | Path] = ()) -> Trees:
    """``parse_all`` of what ``find`` finds. Raises RulecError."""
    return parse_all(find(reference, search_path))


def find(reference: str | Path, search_path: Sequence[str | Path] = ()) -> RulebookFile:
    """Find a rulebook by name or path, and read it. Raises RulecError."""
    folders = tuple(Path(folder) for folder in search_path)
    path = search.find_rulebook(reference, folders)
    return file_of(path, search.read_bytes(path), folders)


def file_of(path: Path, data: bytes, search_path: Sequence[Path] = ()) -> RulebookFile:
    """A rulebook's file that has been read. Raises RulecError if it is not a text."""
    return RulebookFile(decode(str(path), data), data, path, tuple(search_path))


def parse_all(file: RulebookFile, *, keeps: bool = True) -> Trees:
    """Parse a rulebook, its bases, and the vocabularies that they use.

    Mistakes of spelling are in the result. The cache ``keeps`` the rulebook's own tree, or not.
    Raises RulecError R0206 for a vocabulary.
    """
    # What somebody is typing has no path: it is another text each time.
    own, mistakes = parse(file.source) if file.path is None else parsed(file.source, keeps=keeps)
    if own.kind == "vocabulary" and own.name is not None:
        expected = "expected `rulebook NAME`"
        raise RulecError(vocabulary_for_rulebook(own.name, expected=expected))
    return trees_of(file, own, mistakes)


def with_book(trees: Trees, source: Source, search_path: Sequence[Path] = ()) -> Trees:
    """The trees with one more rulebook, which extends the last one, and its vocabularies."""
    book, mistakes = parse(source)
    files = ReferencedFiles(search_path)
    read = [files.vocabulary(use, None) for use in _distinct(book.uses)]
    return Trees(
        name=source.name,
        books=(*trees.books, book),
        vocabularies=(*trees.vocabularies, *(file for file in read if file is not None)),
        sources=(*trees.sources, *files.sources),
        mistakes=(*mistakes, *files.mistakes, *trees.mistakes),
        dependencies=None if files.failed else trees.dependencies,
        search_path=trees.search_path,
    )


def resolve_trees(trees: Trees, at: str = "", traffic: Traffic = "") -> Loaded:
    """Resolve syntax trees to a rulebook. Raises RulecError with every mistake in them."""
    found = resolved(trees, at, traffic)
    if found.rulebook is None:
        raise RulecError(found.findings)
    sources = (file.span.source for file in (*trees.books, *trees.vocabularies))
    return Loaded(found.rulebook, found.findings, {source.name: source for source in sources})


def parse_rulebook(
    text: str, name: str = "<text>", search_path: Sequence[Path] = (), at: str = ""
) -> Rulebook:
    """A rulebook from its text; messages call it ``name``. Raises RulecError."""
    data = text.encode("utf-8", "surrogatepass")
    file = RulebookFile(Source(name, text), data, None, tuple(search_path))
    return resolve_trees(parse_all(file), at).rulebook


def load_vocabulary(name: str, search_path: Sequence[Path] = ()) -> Vocabulary:
    """A vocabulary by its name. Raises RulecError if it is not found or has mistakes."""
    span = Span(Source("<vocabulary>", name), 0, len(name))
    files = ReferencedFiles(search_path)
    file = files.vocabulary(tree.UseLine(tree.Name(name, span=span)), None)
    if file is None or any(mistake.severity == "error" for mistake in files.mistakes):
        raise RulecError(files.mistakes)
    vocabulary, mistakes = resolve_vocabulary(file)
    if vocabulary is None:
        raise RulecError(mistakes)
    return vocabulary


def diagnose(
    name: str, data: bytes, path: Path | None = None, search_path: Sequence[Path] = (), at: str = ""
) -> Diagnosis:
    """All errors and warnings about a rulebook or a vocabulary.

    Args:
        name: what messages call it.
        data: its content.
        path: where it is, so that vocabularies beside it are found; None if that is nowhere.
        search_path: folders of rulebooks and vocabularies.
        at: the day (ISO) whose law it is; if empty, that of its law or else today.
    """
    try:
        source = decode(name, data)
        file, mistakes = parse(source) if path is None else parsed(source, keeps=False)
        if file.kind == "rulebook":
            text = RulebookFile(source, data, path, tuple(search_path))
            trees = trees_of(text, file, mistakes)
            return Diagnosis(resolved(trees, at).findings, trees.dependencies)
        return Diagnosis(vocabulary_findings(file, name, mistakes))
    except RulecError as error:
        return Diagnosis(error.diagnostics)


def trees_of(file: RulebookFile, own: tree.File, mistakes: Sequence[Diagnostic]) -> Trees:
    """The trees of a rulebook that has been parsed, and of its bases and vocabularies."""
    files = ReferencedFiles(file.search_path)
    itself = Book(own, file.path)
    books = (*files.bases(itself), itself)
    read = [files.vocabulary(use, book.path) for book in books for use in _distinct(book.file.uses)]
    return Trees(
        name=file.source.name,
        books=tuple(book.file for book in books),
        vocabularies=tuple(vocabulary for vocabulary in read if vocabulary is not None),
        sources=(source_file(file.source.name, file.data), *files.sources),
        mistakes=(*mistakes, *files.mistakes),
        dependencies=None if files.failed else tuple(files.dependencies),
        search_path=file.search_path,
    )


def day_of(trees: Trees, at: str = "") -> str:
    """The day (ISO) whose law applies: the requested one, that of the law, or today.

    Without a `law` line, the law is that of the nearest base that has one.
    """
    law = law_line(trees.books)
    return at or (law.as_of if law else "") or date.today().isoformat()  # noqa: DTZ011


def resolved(
    trees: Trees, at: str = "", traffic: Traffic = "", translate: Translate = translated
) -> ResolvedTrees:
    """What trees say, and the diagnostics to report, without those that comments allow.

    For unknown words they name the rulebooks and vocabularies that have them.
    """
    made = resolve(
        trees.books,
        trees.vocabularies,
        trees.sources,
        translate,
        opaque=trees.dependencies is None,
        at=day_of(trees, at),
        traffic=traffic,
    )
    mistakes = [*trees.mistakes, *made.mistakes]
    findings = in_order(trees.name, judged_allowances(mistakes, trees.books[-1].span.source))
    read = [file.name.text for file in (*trees.books, *trees.vocabularies) if file.name]
    known = with_words_elsewhere(findings, read, trees.search_path)
    wrong = any(finding.severity == "error" for finding in known)
    noted = with_provisions(known, trees.books)
    return ResolvedTrees(trees, made.names, None if wrong else made.rulebook, noted)


def vocabulary_findings(
    file: tree.File, name: str, mistakes: Sequence[Diagnostic]
) -> tuple[Diagnostic, ...]:
    """All diagnostics about a vocabulary by itself, some of which are known."""
    _, meanings = resolve_vocabulary(file)
    return in_order(name, judged_allowances([*mistakes, *meanings], file.span.source))


def _distinct(uses: Sequence[tree.UseLine]) -> list[tree.UseLine]:
    first: dict[str, tree.UseLine] = {}
    for use in uses:
        first.setdefault(use.name.text, use)
    return list(first.values())


def in_order(main: str, mistakes: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Mistakes by their places, those in the file ``main`` first."""

    def rank(diagnostic: Diagnostic) -> tuple[bool, str, tuple[int, int]]:
        place = diagnostic.place or SourceLocation("")
        return place.file != main, place.file, place.start

    return tuple(sorted(mistakes, key=rank))


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
