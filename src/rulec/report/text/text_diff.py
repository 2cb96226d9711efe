"""Changes in a text, as a unified diff that `patch` takes."""

from __future__ import annotations

import re
from difflib import unified_diff

from rulec.report.findings.source_excerpt import visible

_RESET = "\x1b[0m"
_COLORS = {"---": "\x1b[1m", "+++": "\x1b[1m", "@@": "\x1b[36m", "-": "\x1b[31m", "+": "\x1b[32m"}


def as_diff(name: str, before: str, after: str) -> str:
    """A unified diff of a file's text; empty if nothing changes."""
    old, new = _lines(before), _lines(after)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
        for line in unified_diff(old, new, name, name)
    )


def for_terminal(diff: str, *, color: bool) -> str:
    """The diff for display: no character can drive the terminal."""
    return "".join(f"{_shown(line, color)}\n" for line in diff.removesuffix("\n").split("\n"))


def _lines(text: str) -> list[str]:
    """Split a text at line feeds only, keeping other line ends."""
    return re.findall(r"[^\n]*\n|[^\n]+", text)


def _shown(line: str, color: bool) -> str:
    text = visible(line.replace("\t", "    "))
    paint = next((_COLORS[start] for start in _COLORS if line.startswith(start)), "")
    return f"{paint}{text}{_RESET}" if color and paint else text
