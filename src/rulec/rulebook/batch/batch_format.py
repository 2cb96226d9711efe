"""Formats several files into their canonical form."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from rulec.cache.kept_bytes import KeptBytes
from rulec.diagnostics import Diagnostic, RulecError, SourceLocation
from rulec.files.file_messages import UNREADABLE_FILE, UNWRITABLE_FILE
from rulec.files.left_alone import LeftAlone
from rulec.files.written_files import written_whole
from rulec.rulebook.batch.batch_check import find_sources
from rulec.rulebook.files.search_path import read_bytes
from rulec.rulebook.files.source_walk import FoundSources
from rulec.settings import Exclusion

_IN_FORM = KeptBytes("form", 10_000)
"""Empty files, named by texts that are formatted: they are not parsed again."""


@dataclass(frozen=True, slots=True)
class Formatted:
    """A file before and after formatting; ``path`` is None for standard input."""

    name: str
    path: Path | None
    before: bytes
    after: bytes

    @property
    def changed(self) -> bool:
        """Whether the file is not in canonical form."""
        return self.before != self.after


@dataclass(frozen=True, slots=True)
class FormattedFiles:
    """The formatted files, why others could not be formatted, and what was skipped."""

    files: tuple[Formatted, ...]
    refused: tuple[Diagnostic, ...]
    left_alone: tuple[LeftAlone, ...]


def format_files(
    references: Iterable[str],
    search_path: Sequence[Path] = (),
    excluded: Exclusion | None = None,
) -> FormattedFiles:
    """Format the files at the paths, each once, and collect errors; nothing is written.

    ``search_path`` is used for help when a name is given, ``excluded`` is skipped in folders.
    Raises FormattingError for a bug in rulec.
    """
    known: dict[str, bytes] = {}
    done: dict[str, Formatted] = {}
    refused: list[Diagnostic] = []
    left_alone: list[LeftAlone] = []
    for reference in references:
        try:
            sources = _at(reference, search_path, excluded)
        except RulecError as error:
            refused += error.diagnostics
            continue
        refused += sources.refused
        left_alone += sources.left_alone
        for path in sources.paths:
            identity = os.path.realpath(path)
            if identity in done:
                continue
            try:
                data = read_bytes(path)
                key = _IN_FORM.key(sha256(data).hexdigest())
                if key in known or _IN_FORM.recall(key) is not None:
                    done[identity] = Formatted(str(path), path, data, data)
                    continue
                done[identity] = formatted(str(path), path, data)
                known[_IN_FORM.key(sha256(done[identity].after).hexdigest())] = b""
            except RulecError as error:
                refused += error.diagnostics
    _IN_FORM.keep(known)
    return FormattedFiles(tuple(done.values()), tuple(refused), tuple(left_alone))


def _at(reference: str, search_path: Sequence[Path], excluded: Exclusion | None) -> FoundSources:
    # The file that a rulebook's name stands for is often another's.
    if "/" not in reference and not os.path.lexists(reference):
        elsewhere = _named(reference, search_path)
        if elsewhere is not None:
            message = "there is no such file or folder, only a name"
            way_out = f"give the path that it stands for, `{elsewhere}`"
            raise UNREADABLE_FILE.error(SourceLocation(reference), message, help=way_out)
    if "/" in reference:
        return find_sources(reference, (), excluded)
    is_folder = os.path.isdir(reference)  # noqa: PTH112 - Path raises on a null character
    return find_sources(f"{reference}/" if is_folder else f"./{reference}", (), excluded)


def _named(reference: str, search_path: Sequence[Path]) -> Path | None:
    try:
        paths = find_sources(reference, search_path).paths
    except RulecError:
        return None
    # A pattern is none, whatever it matches.
    return paths[0] if len(paths) == 1 and paths[0] != Path(reference) else None


def formatted(name: str, path: Path | None, data: bytes) -> Formatted:
    """Format one file. Raises RulecError, or FormattingError for a bug in rulec."""
    # The parser, 75 ms: not where all is known to be in form.
    from rulec.syntax.formatting import format_bytes

    return Formatted(name, path, data, format_bytes(name, data))


def replace_files(files: Sequence[Formatted]) -> tuple[Diagnostic, ...]:
    """Write changed files, each completely or not at all; returns the errors."""
    refused: list[Diagnostic] = []
    for file in files:
        if file.path is None or not file.changed:
            continue
        try:
            _replace(file.path, file.after)
        except RulecError as error:
            refused += error.diagnostics
    return tuple(refused)


def _replace(path: Path, data: bytes) -> None:
    if not path.is_file():
        way_out = "give `-` to have standard input formatted to standard output"
        message = "the file cannot be written: it is not a regular file"
        raise UNWRITABLE_FILE.error(SourceLocation(str(path)), message, help=way_out)
    with written_whole(path, in_place=True) as stream:
        stream.write(data)
