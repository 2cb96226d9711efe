"""Texts stored beside the tests; ``pytest --refresh-snapshots`` writes them anew."""

import difflib
import re
from pathlib import Path

import pytest


class Snapshots:
    """The stored texts of a folder."""

    def __init__(self, folder: Path, *, refresh: bool) -> None:
        self._folder = folder
        self._refresh = refresh

    def check(self, name: str, text: str) -> None:
        """Compare a text with the stored one, or store it."""
        path = self._folder / f"{name}.txt"
        if self._refresh:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            return
        if not path.is_file():
            pytest.fail(f"{path} is missing: run pytest with --refresh-snapshots, and read it")
        stored = path.read_text(encoding="utf-8")
        if text != stored:
            changes = difflib.unified_diff(
                stored.splitlines(), text.splitlines(), "stored", "now", lineterm=""
            )
            pytest.fail("\n".join([f"{path.name} has changed:", *changes]))


def timeless(text: str) -> str:
    """The text without how long it took, and without digests, which change with each word."""
    text = re.sub(r"(computed|passed|failed) in [0-9.]+ s", r"\1 in … s", text)
    return re.sub(r"^(by .*)\[[0-9a-f]{8}\]$", r"\1[…]", text, flags=re.MULTILINE)
