"""Locations of rulec's own files, in a checkout or an installed package."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import cache
from hashlib import sha256
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
    """The files of code, grammar and phrases in rulec, in a fixed order."""
    phrases = rulebooks_folder() / "vocabulary" / "phrases"
    folders = [str(_PACKAGE), str(_folder("grammar")), str(phrases)]
    while folders:
        with os.scandir(folders.pop()) as scandir_iterator:
            for entry in sorted(scandir_iterator, key=lambda dir_entry: dir_entry.name):
                if entry.is_dir(follow_symlinks=False):
                    folders += [] if entry.name == "__pycache__" else [entry.path]
                elif entry.name.endswith((".py", ".lark", ".json", ".toml")):
                    yield entry.path, entry.stat()


def emacs_mode() -> Path:
    """The major mode for Emacs."""
    installed = _PACKAGE / "data" / "editors" / "emacs" / "rulec-mode.el"
    return installed if installed.is_file() else _PACKAGE.parent / "editors/emacs/rulec-mode.el"


def scenarios_folder() -> Path:
    """The folder of the built-in scenarios."""
    return _PACKAGE / "scenario" / "builtin"


@cache
def code_digest(names: tuple[str, ...]) -> bytes:
    """A digest of these files and folders of rulec's code; ``grammar`` is the grammars' folder."""
    seen = sha256()
    for path in [_folder(name) if name == "grammar" else _PACKAGE / name for name in names]:
        files = [path] if path.is_file() else sorted(path.rglob("*"))
        for file in files:
            if file.suffix in (".py", ".lark", ".json"):
                data = file.read_bytes()
                seen.update(f"{file.relative_to(path.parent)}\0{len(data)}\0".encode())
                seen.update(data)
    return seen.digest()
