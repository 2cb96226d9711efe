"""Texts that stand in files of their own, with places that are filled in."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TypeAlias

Places: TypeAlias = Mapping[str, int | str | Iterable[str]]
"""Name of a place -> what it stands for: a text, a number, or lines."""

_PLACE = re.compile(r"^([ ]*)@(\w+)@\n|@(\w+)@", re.MULTILINE)


def filled(file: Path, places: Places) -> str:
    """The text of a file of the package with its places filled in.

    A place is ``@name@``. On a line of its own it stands for lines, if any, each as far in as it
    is. What is filled in is not searched for places.
    """

    def content(match: re.Match[str]) -> str:
        indent, lines, text = match.groups()
        if text:
            return str(places[text])
        given = places[lines]
        shown = str(given).splitlines() if isinstance(given, int | str) else given
        return "".join(f"{indent}{line}\n" for line in shown)

    return _PLACE.sub(content, file.read_text(encoding="utf-8"))
