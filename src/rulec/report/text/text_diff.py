"""Changes in a text, as a unified diff for `patch`."""

from __future__ import annotations

import re
from difflib import unified_diff

from rulec.report.text.terminal_text import styled, visible

_STYLES = {"---": "bold", "+++": "bold", "@@": "cyan", "-": "red", "+": "green"}


def as_diff(name: str, before: str, after: str) -> str:
    """A unified diff of a file's text; empty if nothing changes."""
    old, new = _lines(before), _lines(after)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
        for line in unified_diff(old, new, name, name)
    )


def for_terminal(diff: str) -> str:
    """The diff for display, without characters that control a terminal."""
    return "\n".join(map(_shown, diff.removesuffix("\n").split("\n")))


def _lines(text: str) -> list[str]:
    """Split a text at line feeds only, keeping other line ends."""
    return re.findall(r"[^\n]*\n|[^\n]+", text)


def _shown(line: str) -> str:
    style = next((_STYLES[start] for start in _STYLES if line.startswith(start)), "")
    return styled(visible(line.replace("\t", "    ")), style)
