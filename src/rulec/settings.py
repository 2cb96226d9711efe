"""A project's ``rulec.toml``, from the working folder or above it."""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rulec.diagnostics import RulecError, SourceLocation, did_you_mean
from rulec.files.file_messages import OUT_OF_TREE, WRONG_SETTINGS
from rulec.files.read_files import MAX_SETTINGS_BYTES, decoded, opened, read_whole
from rulec.files.work_trees import leads_out, refuse_no_source, tree_of
from rulec.toml import parsed_toml

FILE_NAME = "rulec.toml"
_HOW = 'such as `search_path = ["rulebooks"]`'
_SETTINGS = ("search_path", "exclude")
_INSIDE = (
    "name a folder relative to the file, in the same git work tree, or without one below the file"
)
_LONGEST_NAME = 100


def search_path(folder: Path | None = None) -> tuple[Path, ...]:
    """The folders that are searched first for rulebooks and vocabularies.

    Args:
        folder: where the upward search for ``rulec.toml`` begins; the working folder if None.
            Without such a file there are no folders.

    Raises RulecError: R0701 if it cannot be read, R0101 or R0704 for mistakes in it.
    """
    file = _nearest(folder or Path.cwd())
    return () if file is None else _folders(file, _read(file))


@dataclass(frozen=True, slots=True)
class Exclusion:
    """Files below a folder to be left alone: ``patterns`` as in gitignore(5)."""

    folder: Path
    patterns: tuple[str, ...]


def exclusion() -> Exclusion | None:
    """The ``exclude`` setting of ``rulec.toml``; None without it. Raises RulecError, as above."""
    file = _nearest(Path.cwd())
    patterns = [] if file is None else _read(file)["exclude"]
    return None if file is None or not patterns else Exclusion(file.parent, tuple(patterns))


def settings_file() -> Path | None:
    """The ``rulec.toml`` in the working folder or above it; None if there is none."""
    return _nearest(Path.cwd())


def _nearest(folder: Path) -> Path | None:
    files = (place / FILE_NAME for place in (folder, *folder.parents))
    # A pipe or a broken link is refused, not skipped in favour of settings farther up.
    return next((file for file in files if os.path.lexists(file) and not file.is_dir()), None)


def _read(file: Path) -> Mapping[str, list[str]]:
    """The settings, each as a list of texts."""
    refuse_no_source(file)
    with opened(file) as stream:
        source = decoded(str(file), read_whole(stream, file, MAX_SETTINGS_BYTES))
    settings: dict[str, Any] = parsed_toml(source, WRONG_SETTINGS, _HOW)
    for name in settings:
        if name not in _SETTINGS:
            way_out = did_you_mean(name, _SETTINGS) or "there are `search_path` and `exclude`"
            raise _wrong(file, f"there is no setting `{name}`", way_out)
    for name, of, how in (
        ("search_path", "folders", _HOW),
        ("exclude", "patterns", 'such as `exclude = ["old/", "*.draft.rules"]`'),
    ):
        value = settings.setdefault(name, [])
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise _wrong(file, f"`{name}` is not a list of {of}", how)
        if not all(item.strip() for item in value):
            here = "; the file's own folder is `.`" if name == "search_path" else ""
            raise _wrong(file, f"`{name}` has an empty text in its list", f"leave it out{here}")
    return settings


def _folders(file: Path, settings: Mapping[str, list[str]]) -> tuple[Path, ...]:
    folders = settings["search_path"]
    result = [file.parent / item for item in folders]
    tree = tree_of(file.parent)
    for item, path in zip(folders, result, strict=True):
        try:
            is_folder = stat.S_ISDIR(path.stat().st_mode)
        except (OSError, ValueError):  # including a name that is too long or has a null character
            is_folder = False
        if "\0" in item or Path(item).is_absolute() or leads_out(path, tree):
            raise OUT_OF_TREE.error(
                SourceLocation(str(file)),
                f"`search_path` names `{_cut(item)}`, which is not in the tree of the file",
                help=_INSIDE,
            )
        if not is_folder:
            raise _wrong(
                file,
                f"`search_path` names `{_cut(item)}`, which is no folder",
                f"it is looked for in `{file.parent}`",
            )
    return tuple(result)


def _cut(name: str) -> str:
    return name if len(name) <= _LONGEST_NAME else f"{name[:_LONGEST_NAME]}…"


def _wrong(file: Path, message: str, way_out: str) -> RulecError:
    return WRONG_SETTINGS.error(SourceLocation(str(file)), message, help=way_out)
