"""The last filter for output: nothing may control a terminal, a CI runner or a spreadsheet.

Names come from data, files and compiled rulebooks, and may contain any text. Code that prints a
name makes it `visible`, including line ends; what was forgotten there is escaped here.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from io import RawIOBase
from typing import IO, Any, Final

from rulec.report.text.terminal_text import HIDDEN, as_escape, visible

_STYLE: Final = re.compile("(\x1b\\[[0-9;]*m)")
"""Colours, which rulec itself writes and which do no harm."""
_HIDDEN: Final = re.compile(f"[{HIDDEN}]")
_ANYWHERE: Final = re.compile(r"(?<=#)#(?=\[|vso\[|teamcity\[)")
_AT_START: Final = re.compile(r"^([^\S\n]*):(?=:(?!: ))", re.MULTILINE)
"""Commands of GitHub's, Azure's and TeamCity's runners, anywhere or at the start of a line.

A diagnostic's `::: FILE` is no command, because no command's name begins with a colon.
"""

MARKUP: Final = frozenset({"html", "svg", "junit"})
JSON: Final = frozenset({"json", "jsonl", "sarif"})
_FORMULA: Final = ("=", "+", "-", "@", "\t", "\r", "'")
"""The first character of a cell that a spreadsheet evaluates (OWASP), or reads as a text marker."""


def outgoing(text: str, form: str = "text", *, color: bool = False) -> str:
    """A text made safe for output in a format: no control or reordering characters, no commands.

    In JSON and markup, escaped characters keep their meaning. ``color``: keep styles.
    """
    if form == "csv" and "\r\n" in text:
        # CSV's own line ends, unlike those in names, are kept.
        return "\r\n".join(outgoing(line, form) for line in text.split("\r\n"))
    if form in JSON:
        return _ANYWHERE.sub(r"\\u0023", _HIDDEN.sub(_as_json, text))
    if form == "junit":
        # Its texts contain lines; not for other markup, where styles of pages have lines like
        # these.
        text = _AT_START.sub(r"\1&#x3a;", text)
    if form in MARKUP:
        return _ANYWHERE.sub("&#x23;", _HIDDEN.sub(_as_reference, text))
    if _HIDDEN.search(text):
        parts = _STYLE.split(text) if color else [text]
        # Every second part is a style.
        parts[::2] = [_HIDDEN.sub(as_escape, part) for part in parts[::2]]
        text = "".join(parts)
    if form == "github":
        return text
    return _ANYWHERE.sub(r"\\x23", _AT_START.sub(r"\1\\x3a", text))


class OutgoingLines(RawIOBase):
    """A stream that filters lines in a format on their way to another stream."""

    def __init__(self, stream: IO[bytes], form: str) -> None:
        self._stream = stream
        self._form = form
        self._rest = b""

    def writable(self) -> bool:
        """Return True; code that writes text to the stream asks for it."""
        return True

    def write(self, data: Any) -> int:
        """Take bytes, and pass on the complete lines."""
        lines, end, rest = bytes(data).rpartition(b"\n")
        if end:
            self._put(self._rest + lines + end)
            self._rest = b""
        self._rest += rest
        return len(data)

    def finish(self) -> None:
        """Pass on an incomplete last line."""
        self._put(self._rest)
        self._rest = b""

    def _put(self, lines: bytes) -> None:
        shown = outgoing(lines.decode("utf-8", "surrogateescape"), self._form)
        self._stream.write(shown.encode("utf-8", "surrogateescape"))


def spreadsheet_text(text: str) -> str:
    """A text as a cell; an apostrophe precedes text that a spreadsheet would evaluate."""
    return f"'{text}" if text.startswith(_FORMULA) else text


def _as_json(match: re.Match[str]) -> str:
    return f"\\u{ord(match[0]):04x}"


def _as_reference(match: re.Match[str]) -> str:
    # XML has no references for control characters, so their code is shown.
    code = ord(match[0])
    return f"&#x{code:x};" if code > 0x9F and not 0xD800 <= code < 0xE000 else as_escape(match)


def csv_text(rows: Iterable[Iterable[object]], line_end: str = "\r\n") -> str:
    """Lines of texts and numbers; items of a tuple are separated by semicolons, None is empty."""
    text = io.StringIO()
    csv.writer(text, lineterminator=line_end).writerows(map(_cell, row) for row in rows)
    return text.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, tuple):
        value = "; ".join(value)
    return spreadsheet_text(visible(value)) if isinstance(value, str) else repr(value)
