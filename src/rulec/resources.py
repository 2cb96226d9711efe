"""Locations of rulec's own files, in a checkout or an installed package."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _folder(name: str) -> Path:
    installed = _PACKAGE / "data" / name
    return installed if installed.is_dir() else _PACKAGE.parent.parent / name


def grammar_file(name: str) -> Path:
    """The path of a grammar, such as ``rulec.lark``."""
    return _folder("grammar") / name


def rulebooks_folder() -> Path:
    """The folder of the rulebooks and vocabularies that ship with rulec."""
    return _folder("rulebooks")


def package_files() -> Iterator[tuple[str, os.stat_result]]:
    """The files of code, grammar and vocabularies in rulec, in a fixed order."""
    words = rulebooks_folder() / "vocabulary"
    folders = [str(_PACKAGE), str(_folder("grammar")), str(words)]
    while folders:
        with os.scandir(folders.pop()) as scandir_iterator:
            for entry in sorted(scandir_iterator, key=lambda dir_entry: dir_entry.name):
                if entry.is_dir(follow_symlinks=False):
                    folders += [] if entry.name == "__pycache__" else [entry.path]
                elif entry.name.endswith((".py", ".lark", ".json", ".toml", ".rules")):
                    yield entry.path, entry.stat()


def emacs_mode() -> Path:
    """The major mode for Emacs."""
    installed = _PACKAGE / "data" / "editors" / "emacs" / "rulec-mode.el"
    return installed if installed.is_file() else _PACKAGE.parent / "editors/emacs/rulec-mode.el"


def scenarios_folder() -> Path:
    """The folder of the built-in scenarios."""
    return _PACKAGE / "scenario" / "builtin"
