"""The sources in a folder at any depth, and what is skipped there."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from os.path import islink, lexists
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, SourceLocation
from rulec.files.file_messages import NOTHING_LEFT, UNREADABLE_FILE
from rulec.files.left_alone import LeftAlone, in_words
from rulec.files.source_detection import LEAD_BYTES, beginning_of, is_foreign
from rulec.files.work_trees import is_ordinary, refuse_no_source, tree_of
from rulec.rulebook.files.git_ignores import (
    IgnoreFile,
    ignore_files,
    is_ignored,
    pattern_of,
    patterns_in,
)
from rulec.settings import Exclusion

SUFFIX = ".rules"

ENVIRONMENTS = frozenset({"__pypackages__", "node_modules", "site-packages", "venv"})
"""Folders of other authors' programs; hidden ones such as ``.venv`` are skipped anyway."""

DEEPEST_FOLDER = 200
"""Deeper folders are not entered."""

_MARKS = ("pyvenv.cfg", "conda-meta")
"""A folder with one of these is a Python environment, whatever its name."""


@dataclass(slots=True)
class FoundSources:
    """Sources in order, what was skipped, and what was refused."""

    paths: list[Path] = field(default_factory=list)
    left_alone: list[LeftAlone] = field(default_factory=list)
    refused: list[Diagnostic] = field(default_factory=list)


def sources_below(folder: str, excluded: Exclusion | None = None) -> FoundSources:
    """The sources in a folder at any depth, in order.

    Hidden folders, environments, links to folders and very deep folders are not entered. Files that
    git ignores, that are ``excluded``, or that begin with neither `rulebook` nor `vocabulary`, are
    skipped. Links out of the tree, pipes and devices are refused.
    """
    sources = FoundSources()
    top = Path(os.path.abspath(folder))  # noqa: PTH100 - Path.absolute() keeps `..`
    tree = tree_of(top)
    ignored: dict[Path, list[IgnoreFile]] = {top: ignore_files(top, tree)}
    own = _patterns(excluded)

    def unreadable(problem: OSError) -> None:
        sources.refused.append(_locked(problem))

    for here, folders, names in os.walk(folder, onerror=unreadable):
        place = Path(os.path.normpath(top / os.path.relpath(here, folder)))
        files = ignored.pop(place)
        entered = []
        for name in sorted(folders):
            deep = "too deep" if len(place.parts) - len(top.parts) >= DEEPEST_FOLDER else ""
            by_hand = _is_excluded(place / name, own, is_folder=True)
            if why := _why_not_entered(place / name, files) or by_hand or deep:
                if not name.startswith("."):
                    sources.left_alone.append(LeftAlone(str(Path(here, name)), why))
                continue
            entered.append(name)
            ignored[place / name] = [*files, *patterns_in(place / name, tree)]
        folders[:] = entered
        for name in sorted(name for name in names if name.endswith(SUFFIX)):
            is_left = is_ignored(place / name, files, is_folder=False)
            why = "ignored by git" if is_left else _is_excluded(place / name, own)
            _sort(Path(here, name), why, tree, sources)
    if not sources.paths and not sources.refused:
        sources.refused.append(_nothing_left(folder, sources.left_alone))
    return sources


def _why_not_entered(folder: Path, files: Sequence[IgnoreFile]) -> str:
    if folder.name.startswith("."):
        return "hidden"
    if folder.name in ENVIRONMENTS or any(lexists(folder / mark) for mark in _MARKS):
        return "an environment"
    if islink(folder):  # noqa: PTH114 - the other way raises what a system says of a path
        return "a link to a folder"
    return "ignored by git" if is_ignored(folder, files, is_folder=True) else ""


def _patterns(excluded: Exclusion | None) -> IgnoreFile | None:
    if excluded is None:
        return None
    return IgnoreFile(excluded.folder, tuple(filter(None, map(pattern_of, excluded.patterns))))


def _is_excluded(path: Path, own: IgnoreFile | None, *, is_folder: bool = False) -> str:
    """Why the project's own settings exclude a path; empty if they do not."""
    if own is None or own.folder not in path.parents:
        return ""
    return "excluded" if is_ignored(path, [own], is_folder=is_folder) else ""


def _sort(path: Path, left: str, tree: Path, sources: FoundSources) -> None:
    """Add a file to its list, ``left`` being the reason to skip it."""
    if left:
        sources.left_alone.append(LeftAlone(str(path), left))
        return
    try:
        refuse_no_source(path, tree=tree)
    except RulecError as error:
        sources.refused += error.diagnostics
        return
    if is_other_file(path):
        sources.left_alone.append(LeftAlone(str(path), "no rulebook and no vocabulary"))
    else:
        sources.paths.append(path)


def is_other_file(path: Path) -> bool:
    """Whether a file belongs to another program. Unreadable and empty files do not."""
    try:
        with path.open("rb") as stream:
            data = stream.read(LEAD_BYTES)
    except (OSError, ValueError):
        return False
    return is_foreign(beginning_of(data))


def _nothing_left(folder: str, left_alone: Sequence[LeftAlone]) -> Diagnostic:
    reasons = in_words(left_alone)
    compiled = next(filter(_is_compiled, sorted(Path(folder).glob("*.json"))), None)
    way_out = "give a folder with files whose names end in `.rules`, or a file by its own path"
    if compiled is not None:
        way_out = f"a compiled rulebook is given by its file: `{compiled}`"
    return NOTHING_LEFT.at(
        SourceLocation(folder),
        "there is no rulebook and no vocabulary in this folder",
        help=way_out,
        notes=(f"left alone: {reasons}",) if reasons else (),
    )


def _is_compiled(path: Path) -> bool:
    with suppress(OSError):
        if path.is_file():
            with path.open("rb") as stream:
                return b'"rulec compiled rulebook"' in stream.read(_HEAD_BYTES)
    return False


_HEAD_BYTES = 1000
"""The first bytes of a compiled rulebook, which contain its format."""


def _locked(problem: OSError) -> Diagnostic:
    message = f"the folder cannot be read: {(problem.strerror or str(problem)).lower()}"
    place = SourceLocation(os.fsdecode(problem.filename))
    return UNREADABLE_FILE.at(place, message, help="check its permissions")


def rules_files(folder: Path) -> Iterator[Path]:
    """Files at any depth of a folder that may be sources.

    Pipes and links out of it are left out.
    """
    tree = tree_of(folder)
    with suppress(OSError):
        for pattern in (f"*{SUFFIX}", f"*/*{SUFFIX}"):
            yield from (path for path in folder.glob(pattern) if _is_own(path, tree))


def _is_own(path: Path, tree: Path) -> bool:
    try:
        refuse_no_source(path, tree=tree)
    except RulecError:
        return False
    return is_ordinary(path)
