"""Rulec as it is installed: its own files, how an extra is added, variables of its environment."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.util import find_spec
from json import loads
from pathlib import Path
from shlex import quote
from urllib.parse import unquote

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


def codes_page() -> Path:
    """The page that explains every code, part of the documentation."""
    installed = _PACKAGE / "data" / "codes.md"
    return installed if installed.is_file() else _PACKAGE.parent.parent / "docs" / "codes.md"


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


@cache
def install_command(extra: str) -> str:
    """A command such as ``pip install 'rulec[rates]'`` for this Python and rulec's origin.

    The origin is the checkout or file that rulec was installed from; otherwise its name is used.
    """
    # Imported late (20 ms): only needed if a package is missing.
    from importlib.metadata import PackageNotFoundError, distribution

    python = quote(sys.executable)
    # An environment made by uv has no pip.
    pip = f"{python} -m pip install" if find_spec("pip") else f"uv pip install --python {python}"
    with suppress(PackageNotFoundError, OSError, ValueError):
        origin = loads(distribution("rulec").read_text("direct_url.json") or "{}")
        if origin.get("url", "").startswith("file://"):
            path = unquote(origin["url"].removeprefix("file://"))
            editable = "-e " if origin.get("dir_info", {}).get("editable") else ""
            return f"{pip} {editable}{quote(f'{path}[{extra}]')}"
    return f"{pip} {quote(f'rulec[{extra}]')}"


@contextmanager
def variable_set(name: str, value: str | None) -> Iterator[None]:
    """Set an environment variable in a block, or unset it for None, and restore it afterwards."""
    before = os.environ.get(name)
    _set(name, value)
    try:
        yield
    finally:
        _set(name, before)


def _set(name: str, value: str | None) -> None:
    if value is not None:
        os.environ[name] = value
    else:
        os.environ.pop(name, None)
