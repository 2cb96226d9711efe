"""Check of several rulebooks and vocabularies at once."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from glob import glob, has_magic
from pathlib import Path
from typing import Any

from rulec.diagnostics import Diagnostic, RulecError, SourceLocation
from rulec.diagnostics.diagnostic import diagnostic_rows
from rulec.diagnostics.fault_messages import contained
from rulec.files.file_messages import NOTHING_LEFT
from rulec.files.left_alone import LeftAlone
from rulec.files.source_detection import beginning_of, first_word_at
from rulec.rulebook.files import search_path as search
from rulec.rulebook.files.reference_messages import EXTENDS_CIRCLE, NAME_NOT_FOUND
from rulec.rulebook.files.source_walk import SUFFIX, FoundSources, sources_below
from rulec.rulebook.reading.reading_cache import BookQuestion, recalled, remember_findings
from rulec.settings import Exclusion
from rulec.value_display import Rows, short_repr

_STANDARD_INPUT = Path("standard input")


@dataclass(frozen=True, slots=True)
class Checked(Rows):
    """The result of a batch check: checked files, findings, unread and skipped files.

    ``uncited`` are rules without a provision, ``untested`` those without an example; neither is a
    mistake.
    """

    __repr__ = short_repr

    files: tuple[str, ...]
    findings: tuple[Diagnostic, ...]
    unread: tuple[Diagnostic, ...]
    left_alone: tuple[LeftAlone, ...] = ()
    uncited: tuple[str, ...] = ()
    untested: tuple[str, ...] = ()

    def rows(self) -> list[dict[str, Any]]:
        """Rows of the findings and of the files that are unreadable."""
        return diagnostic_rows((*self.findings, *self.unread))


def check(
    references: Iterable[str],
    standard_input: Callable[[], bytes],
    search_path: Sequence[Path] = (),
    at: str = "",
    excluded: Exclusion | None = None,
) -> Checked:
    """Check the files that references name; report each finding once.

    Args:
        references: names of rulebooks and vocabularies, paths of files, folders, ``-``.
        standard_input: the text that ``-`` stands for, as of a file of the working directory.
        search_path: folders of rulebooks and vocabularies.
        at: the day (ISO) whose law it is; if empty, that of each `law` line or else today.
        excluded: what is left alone in folders.
    """
    files: dict[str, str] = {}
    findings: dict[tuple[object, ...], Diagnostic] = {}
    sources = FoundSources()
    unread = sources.refused
    uncited: list[str] = []
    untested: list[str] = []
    for path in _named_sources(references, search_path, excluded, sources):
        try:
            data = standard_input() if path is _STANDARD_INPUT else search.read_bytes(path)
        except RulecError as error:
            unread += error.diagnostics
            continue
        identity = os.path.realpath(path)
        if identity in files:
            continue
        files[identity] = str(path)
        try:
            with contained("not checked", SourceLocation(str(path))):
                for names, bare in zip(
                    (uncited, untested), bare_rules(data.decode(errors="replace")), strict=True
                ):
                    names += bare
                question = BookQuestion(
                    str(path), data, tuple(search_path), at, has_path=path is not _STANDARD_INPUT
                )
                for finding in _findings(question):
                    findings.setdefault(_identity(finding), finding)
        except RulecError as error:
            unread += error.diagnostics
    return Checked(
        tuple(files.values()),
        tuple(findings.values()),
        tuple(unread),
        left_alone=tuple(sources.left_alone),
        uncited=tuple(uncited),
        untested=tuple(untested),
    )


def _findings(question: BookQuestion) -> tuple[Diagnostic, ...]:
    """All errors and warnings about a rulebook or a vocabulary."""
    reading, _ = recalled(question)
    if reading is not None:
        return reading.findings
    from rulec.rulebook import loader  # the parser takes 60 ms, and what is known needs none

    name, folders = question.name, question.search_path
    diagnosis = loader.diagnose(name, question.data, Path(name), folders, question.at)
    if diagnosis.dependencies is not None:
        remember_findings(question, diagnosis.findings, diagnosis.dependencies)
    return diagnosis.findings


def _named_sources(
    references: Iterable[str],
    search_path: Sequence[Path],
    excluded: Exclusion | None,
    sources: FoundSources,
) -> Iterator[Path]:
    for reference in references:
        if reference == "-":
            yield _STANDARD_INPUT
            continue
        try:
            below = find_sources(reference, search_path, excluded)
        except RulecError as error:
            sources.refused += error.diagnostics
            continue
        sources.refused += below.refused
        sources.left_alone += below.left_alone
        yield from below.paths


def named_rulebooks(
    references: Iterable[str],
    search_path: Sequence[Path] = (),
    excluded: Exclusion | None = None,
) -> tuple[list[str], FoundSources]:
    """The names and paths of rulebooks, with those in folders and those that match patterns.

    Vocabularies in folders and patterns are left out. The second result has what was skipped and
    refused.
    """
    names: dict[str, None] = {}
    on_the_way = FoundSources()
    for reference in references:
        known = "/" not in reference and reference in search.available_rulebooks(search_path)
        if known or not (has_magic(reference) or os.path.isdir(reference)):  # noqa: PTH112
            names[reference] = None
            continue
        sources = find_sources(reference, search_path, excluded)
        on_the_way.left_alone += sources.left_alone
        on_the_way.refused += sources.refused
        rulebooks = [path for path in sources.paths if not is_vocabulary(path)]
        if sources.paths and not rulebooks:
            on_the_way.refused.append(
                NOTHING_LEFT.at(
                    SourceLocation(reference),
                    "there are vocabularies, and no rulebook",
                    help="give a folder with rulebooks, or the path of one",
                )
            )
        # A file in the working folder would be taken for a name.
        names |= {str(path) if "/" in str(path) else f"./{path}": None for path in rulebooks}
    return list(names), on_the_way


def is_vocabulary(path: Path) -> bool:
    """Whether a file says that it is a vocabulary."""
    with suppress(RulecError):
        text = beginning_of(search.read_bytes(path))
        start, end = first_word_at(text)
        return text[start:end] == "vocabulary"
    return False


def _identity(diagnostic: Diagnostic) -> tuple[object, ...]:
    # Every rulebook that uses a vocabulary finds its mistakes again, perhaps by another path.
    place = diagnostic.place
    if diagnostic.code == EXTENDS_CIRCLE.code:
        # Each rulebook of a circle finds it, and another line that closes it.
        places = [place, *[label.place for label in diagnostic.labels]]
        lines = {
            (os.path.realpath(location.file), location.line)
            for location in places
            if location is not None
        }
        return diagnostic.code, frozenset(lines)
    where = () if place is None else (os.path.realpath(place.file), place.start, place.end_column)
    return diagnostic.code, diagnostic.message, where


def find_sources(
    reference: str, search_path: Sequence[Path] = (), excluded: Exclusion | None = None
) -> FoundSources:
    """The files that a name, a path, a folder or a pattern refers to.

    A folder stands for the sources in it and below it, as ``sources_below`` finds them. Where no
    file is called so, ``*``, ``?`` and ``[…]`` are wild and ``**`` is any number of folders. A path
    that leads nowhere is returned as it is; reading it tells why. Raises RulecError R0703 for an
    unknown name.
    """
    is_path = "/" in reference or reference.endswith(".rules")
    if not is_path:
        rulebooks = search.available_rulebooks(search_path)
        vocabularies = {path.stem: path for path in search.available_vocabularies(search_path)}
        if reference in rulebooks:
            return FoundSources([search.find_rulebook(reference, search_path)])
        if reference in vocabularies:
            return FoundSources([vocabularies[reference]])
    if os.path.isdir(reference):  # noqa: PTH112 - Path raises on a null character
        return sources_below(reference, excluded)
    if has_magic(reference) and not os.path.lexists(reference):
        return _matching(reference, excluded)
    if not is_path:
        raise NAME_NOT_FOUND.error(
            None,
            f"there is no rulebook, vocabulary or folder `{reference}`",
            help=search.meant_by(reference, [*rulebooks, *vocabularies], search_path),
            notes=(search.BY_PATH,),
        )
    return FoundSources([Path(reference)])


def _matching(pattern: str, excluded: Exclusion | None) -> FoundSources:
    """The sources that match a pattern, and those in folders that match it."""
    sources = FoundSources()
    # As the shell does it: what begins with a point has to be named so.
    for path in sorted(glob(pattern, recursive=True)):  # noqa: PTH207
        if os.path.isdir(path):  # noqa: PTH112
            below = sources_below(path, excluded)
            sources.paths += below.paths
            sources.left_alone += below.left_alone
        elif path.endswith(SUFFIX):
            sources.paths.append(Path(path))
    if not sources.paths:
        sources.refused.append(
            NOTHING_LEFT.at(
                SourceLocation(pattern),
                "no rulebook and no vocabulary is called like that",
                help="`*`, `?` and `[…]` stand for other letters; check the pattern and the "
                "working folder",
            )
        )
    return sources


# What cites an empty text cites nothing.
_COMMENT_OR_TEXT = re.compile(r'\bcite\s*"[ \t]*"|"[^"\n]*"|#[^\n]*')
_RULE = re.compile(r"(?:^|[\s}])(override\s+)?(?:hard|soft)\s+rule\s+(\w+)|\bconfirm\s+rule\b")
_CITE = re.compile(r"\bcite\b")
_EXAMPLE = re.compile(r"\b(?:accept|reject)\b")


def bare_rules(text: str) -> tuple[list[str], list[str]]:
    """The rules that cite nothing, and those that have no example; overrides are left out.

    They are found without parsing, for a remark on files without mistakes.
    """
    plain = _COMMENT_OR_TEXT.sub(" ", text)
    heads = [*_RULE.finditer(plain)]
    ends = [*[head.start() for head in heads], len(plain)][1:]
    rules = [
        (head[2], plain[head.end() : end])
        for head, end in zip(heads, ends, strict=True)
        if head[2] and not head[1]
    ]
    return (
        [name for name, body in rules if not _CITE.search(body)],
        [name for name, body in rules if not _EXAMPLE.search(body)],
    )
