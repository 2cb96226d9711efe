"""Where rulec's own files are: at the top of a checkout, or inside an installed package."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _folder(name: str) -> Path:
    installed = _PACKAGE / "data" / name
    return installed if installed.is_dir() else _PACKAGE.parent.parent / name


def grammar_file(name: str) -> Path:
    """A grammar, such as ``rulec.lark``."""
    return _folder("grammar") / name


def rulebooks_folder() -> Path:
    """The folder of the rulebooks and vocabularies that ship with rulec."""
    return _folder("rulebooks")


def scenarios_folder() -> Path:
    """The folder of the built-in scenarios."""
    return _PACKAGE / "scenario" / "builtin"
