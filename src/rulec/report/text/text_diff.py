"""Changes in a text, as a unified diff for `patch`."""

from __future__ import annotations

import os
import re
from difflib import unified_diff
from string import ascii_letters, digits

from rulec.report.text.outgoing import outgoing
from rulec.report.text.terminal_text import styled, visible

_PLAIN = frozenset(f"{ascii_letters}{digits} ./_-".encode())
_STYLES = {"---": "bold", "+++": "bold", "@@": "cyan", "-": "red", "+": "green"}


def as_diff(name: str, before: str, after: str) -> str:
    """A unified diff of a file's text; empty if nothing changes."""
    old, new, head = _lines(before), _lines(after), _head(name)
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"
        for line in unified_diff(old, new, head, head)
    )


def for_terminal(diff: str) -> str:
    """The diff for display, without characters that control a terminal."""
    return "\n".join(map(_shown, diff.removesuffix("\n").split("\n")))


def _head(name: str) -> str:
    """A file's name as `patch` reads it: it ends at a blank, unless a tab follows.

    A name that cannot be shown as it is becomes a string as in C.
    """
    if name == outgoing(visible(name)):
        return f"{name}\t" if " " in name else name
    signs = [chr(byte) if byte in _PLAIN else f"\\{byte:03o}" for byte in os.fsencode(name)]
    return '"{}"'.format("".join(signs))


def _lines(text: str) -> list[str]:
    """Split a text at line feeds only, keeping other line ends."""
    return re.findall(r"[^\n]*\n|[^\n]+", text)


def _shown(line: str) -> str:
    style = next((_STYLES[start] for start in _STYLES if line.startswith(start)), "")
    return styled(visible(line.replace("\t", "    ")), style)
