"""The last gate of what is printed: nothing drives a terminal, a runner or a spreadsheet.

Names come from data, from files and from compiled rulebooks, and may be any text. Whoever
prints one makes it `visible`, line ends included; what was forgotten there is escaped here.
"""

from __future__ import annotations

import re
from io import RawIOBase
from typing import IO, Any, Final

_CONTROLS: Final = "\x00-\x08\x0b-\x1f\x7f-\x9f"
REORDERING: Final = "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"
_STYLE: Final = re.compile("(\x1b\\[[0-9;]*m)")
"""Colours, which rulec writes itself, and which cannot do harm."""
_HIDDEN: Final = re.compile(f"[{_CONTROLS}{REORDERING}\u2028\u2029\ufeff\ud800-\udfff]")
_ANYWHERE: Final = re.compile(r"(?<=#)#(?=\[|vso\[|teamcity\[)")
_AT_START: Final = re.compile(r"^([^\S\n]*):(?=:(?!: ))", re.MULTILINE)
"""What GitHub's, Azure's and TeamCity's runners obey, wherever it stands or where a line begins.

A diagnostic's `::: FILE` is no command: none has a name that begins with a colon.
"""

MARKUP: Final = frozenset({"html", "svg", "junit", "xqar"})
JSON: Final = frozenset({"json", "jsonl", "sarif"})
_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r", "'")
"""How a cell begins that a spreadsheet computes (OWASP), or takes for a text by this sign."""


def outgoing(text: str, form: str = "text", *, color: bool = False) -> str:
    """A text as it may go out in a format: no control or reordering character, no command.

    In JSON and markup what is escaped keeps its meaning. ``color``: styles stay.
    """
    if form == "csv" and "\r\n" in text:
        # Its own line ends, and not those of names.
        return "\r\n".join(outgoing(line, form) for line in text.split("\r\n"))
    if form in JSON:
        return _ANYWHERE.sub(r"\\u0023", _HIDDEN.sub(_as_json, text))
    if form == "junit":
        # Its texts have lines of their own; styles of pages begin lines so, too.
        text = _AT_START.sub(r"\1&#x3a;", text)
    if form in MARKUP:
        return _ANYWHERE.sub("&#x23;", _HIDDEN.sub(_as_reference, text))
    if _HIDDEN.search(text):
        parts = _STYLE.split(text) if color else [text]
        # Every second one is a style.
        parts[::2] = [_HIDDEN.sub(_as_escape, part) for part in parts[::2]]
        text = "".join(parts)
    if form == "github":
        return text
    return _ANYWHERE.sub(r"\\x23", _AT_START.sub(r"\1\\x3a", text))


class OutgoingLines(RawIOBase):
    """A stream of lines in a format, on its way to another one."""

    def __init__(self, stream: IO[bytes], form: str) -> None:
        self._stream = stream
        self._form = form
        self._rest = b""

    def writable(self) -> bool:
        """Yes, which is asked by what writes text to it."""
        return True

    def write(self, data: Any) -> int:
        """Take bytes, and put the lines among them that are whole."""
        lines, end, rest = bytes(data).rpartition(b"\n")
        if end:
            self._put(self._rest + lines + end)
            self._rest = b""
        self._rest += rest
        return len(data)

    def finish(self) -> None:
        """Put what has no line end yet."""
        self._put(self._rest)
        self._rest = b""

    def _put(self, lines: bytes) -> None:
        shown = outgoing(lines.decode("utf-8", "surrogateescape"), self._form)
        self._stream.write(shown.encode("utf-8", "surrogateescape"))


def spreadsheet_text(text: str) -> str:
    """A text as a cell; what a spreadsheet would compute gets an apostrophe before it."""
    return f"'{text}" if text.startswith(_FORMULA) else text


def _as_json(match: re.Match[str]) -> str:
    return f"\\u{ord(match[0]):04x}"


def _as_reference(match: re.Match[str]) -> str:
    # XML has no reference for control characters, which therefore are shown as such.
    code = ord(match[0])
    return f"&#x{code:x};" if code > 0x9F and not 0xD800 <= code < 0xE000 else _as_escape(match)


def _as_escape(match: re.Match[str]) -> str:
    code = ord(match[0])
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"
