"""What changes in a text, as a unified diff that `patch` takes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from difflib import unified_diff

from rulec.report.excerpt import visible

_RESET = "\x1b[0m"
_COLORS = {"---": "\x1b[1m", "+++": "\x1b[1m", "@@": "\x1b[36m", "-": "\x1b[31m", "+": "\x1b[32m"}


def as_diff(name: str, before: str, after: str) -> str:
    """A unified diff of a file's text; empty if nothing changes."""
    old, new = _lines(before), _lines(after)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
        for line in unified_diff(old, new, name, name)
    )


def in_color(diff: str) -> str:
    """A diff for a terminal, which no character in it can drive."""
    return "\n".join(_painted(diff)) + "\n"


def _lines(text: str) -> list[str]:
    """Only a line feed ends a line; other line ends are what has to change."""
    return re.findall(r"[^\n]*\n|[^\n]+", text)


def _painted(diff: str) -> Iterator[str]:
    for line in diff.removesuffix("\n").split("\n"):
        color = next((_COLORS[start] for start in _COLORS if line.startswith(start)), "")
        text = visible(line.replace("\t", "    "))
        yield f"{color}{text}{_RESET}" if color else text
