"""The files denoted by paths, folders and patterns."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation
from rulec.files.file_messages import UNREADABLE_FILE
from rulec.files.left_alone import LeftAlone, in_words
from rulec.files.read_files import is_folder, what_reads
from rulec.files.work_trees import refuse_link_out, tree_of
from rulec.recordings.encodings.csv_head import PARQUET
from rulec.recordings.format_table import FORMATS
from rulec.recordings.recording_files import check_readable
from rulec.recordings.recording_format import RECORDING, Glance

STANDARD_INPUT = "-"


@dataclass(frozen=True, slots=True)
class SearchedFolder:
    """A searched folder: how many recordings it has, and its other files."""

    path: str
    recordings: int
    left_alone: tuple[LeftAlone, ...] = ()

    @property
    def in_words(self) -> str:
        """Such as ``3 recordings in drives; left alone: 1 of rulec's own (drives/a.rules)``."""
        plural = "" if self.recordings == 1 else "s"
        others = f"; left alone: {in_words(self.left_alone)}" if self.left_alone else ""
        return f"{self.recordings:,} recording{plural} in {self.path}{others}"


@dataclass(frozen=True, slots=True)
class InputFiles:
    """The files: ``paths`` in order, each once, and why others cannot be read."""

    paths: tuple[str, ...]
    searched: tuple[SearchedFolder, ...] = ()
    problems: tuple[RulecError, ...] = ()


def input_files(arguments: Sequence[str]) -> InputFiles:
    """The files denoted by these arguments; they are not read yet.

    A folder stands for all recordings in it, at any depth, by name; hidden folders, maps and files
    that are read along with others are skipped. If no file has the given name, ``*``, ``?`` and
    ``[…]`` are wildcards, and ``**`` is any number of folders. Everything else is a file, ``-``
    standard input.
    """
    paths: dict[str, None] = {}
    searched: list[SearchedFolder] = []
    problems: list[RulecError] = []
    for argument in arguments:
        for path in _matching(argument, problems):
            if path == STANDARD_INPUT or not is_folder(Path(path)) or _is_recording(Path(path)):
                paths[path] = None
                continue
            recordings, left_alone, refused = _recordings_below(path)
            problems += refused
            if not recordings and not refused:
                why = "there is no recorded traffic in this folder, nor below it"
                problems.append(RECORDING.refused(Path(path), why, help_text=_as_traces(path)))
            paths |= dict.fromkeys(recordings)
            searched.append(SearchedFolder(path, len(recordings), left_alone))
    return InputFiles(tuple(paths), tuple(searched), tuple(problems))


def _as_traces(folder: str) -> str:
    """How to give the traces of a folder, if it seems to contain some; else empty."""
    for ending in (".jsonl", ".csv", ".parquet"):
        if any(Path(folder).glob(f"*{ending}")):
            pattern = Path(folder) / f"*{ending}"
            return (
                f"a folder is that of its recordings; traces are given by files, as by `{pattern}`"
            )
    return ""


def _matching(argument: str, problems: list[RulecError]) -> Sequence[str]:
    """The paths that match a pattern, in order; anything else unchanged."""
    if not glob.has_magic(argument) or os.path.lexists(argument):
        return [argument]
    # As the shell does it: what begins with a point has to be named so.
    paths = sorted(glob.glob(argument, recursive=True))  # noqa: PTH207
    # What is in a folder that matches, too, counts as the folder's.
    files = []
    for path in paths:
        if not Path(path).is_dir():
            try:
                refuse_link_out(Path(path))
                files.append(path)
            except RulecError as error:
                problems.append(error)
    if not paths:
        message = "no file is called like that; `*`, `?` and `[…]` stand for other letters"
        problems.append(
            UNREADABLE_FILE.error(
                SourceLocation(argument), message, help="check the pattern and the working folder"
            )
        )
    return files or [path for path in paths if Path(path).is_dir()]


def _recordings_below(folder: str) -> tuple[list[str], tuple[LeftAlone, ...], list[RulecError]]:
    """The recordings in a folder at any depth, other files, and links out of it."""
    recordings: list[str] = []
    refused: list[RulecError] = []
    left_alone: list[LeftAlone] = []
    tree = tree_of(Path(folder))
    for path in _walk(folder):
        try:
            refuse_link_out(path, tree=tree)
            if _is_recording(path):
                recordings.append(str(path))
                continue
            if path.name.lower().endswith(PARQUET):
                # What is left of a damaged one is no other file
                check_readable(path)
        except RulecError as error:
            refused.append(error)
            continue
        left_alone.append(LeftAlone(str(path), _why_left(path)))
    return recordings, tuple(left_alone), refused


def _why_left(path: Path) -> str:
    """Why a file is no recording by itself."""
    glance = Glance(path)
    if any(form.recognises(glance) for form in FORMATS):
        return "read along with others"
    return "of rulec's own" if what_reads(str(path)) else "without recorded traffic"


DEEPEST_FOLDER = 200
"""Deeper folders are not searched."""


def _walk(folder: str) -> Iterator[Path]:
    """Files, and folders that are recordings, at any depth of a folder; links are not followed."""
    top = len(Path(folder).parts)
    for at, folders, names in os.walk(folder):
        kept = sorted(name for name in folders if not name.startswith("."))
        whole = [name for name in kept if _is_recording(Path(at, name))]
        deep = len(Path(at).parts) - top >= DEEPEST_FOLDER
        folders[:] = [] if deep else [name for name in kept if name not in whole]
        files = (name for name in names if name[0] != "." and Path(at, name).is_file())
        yield from (Path(at, name) for name in sorted([*whole, *files]))


def _is_recording(path: Path) -> bool:
    """Whether some format recognises a path, unless it is read along with another file.

    A file that cannot be opened counts as one, so that the reader reports why.
    """
    glance = Glance(path)
    try:
        form = next((form for form in FORMATS if form.recognises(glance)), None)
        return form is not None and not form.is_companion(glance)
    except RulecError:
        return not path.is_dir()
