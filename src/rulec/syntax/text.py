"""From bytes to a source: encoding and size."""

from __future__ import annotations

from typing import Final

from rulec.diagnostics import Diagnostic, RulecError, Source, Span
from rulec.diagnostics.source import Place

MAX_BYTES: Final = 5_000_000
"""A rulebook has thousands of characters; millions are a mistake."""

_BOM = "\ufeff"
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def decode(name: str, data: bytes) -> Source:
    """The text of a rulebook file; a byte order mark is dropped.

    Raises:
        RulecError: more than ``MAX_BYTES``, not UTF-8, or not a text at all.
    """
    if len(data) > MAX_BYTES:
        raise RulecError(_too_large(name, len(data)))
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as reason:
        raise RulecError(_not_utf8(name, data, reason.start)) from None
    return checked(Source(name, text.removeprefix(_BOM)))


def checked(source: Source) -> Source:
    """The same source, if it can be a rulebook's text.

    Raises:
        RulecError: too large, or it holds a null character.
    """
    if len(source.text) > MAX_BYTES:
        raise RulecError(_too_large(source.name, len(source.text)))
    null = source.text.find("\0")
    if null >= 0:
        place = Span(source, null, null + 1).place
        raise RulecError(
            Diagnostic(
                "R0101",
                "the file holds a null character and is not a text",
                place,
                help="rulebooks are plain text in UTF-8, with names that end in `.rules`",
            )
        )
    return source


def _too_large(name: str, size: int) -> Diagnostic:
    return Diagnostic(
        "R0102",
        f"the file has {size:,} characters, and at most {MAX_BYTES:,} are read",
        Place(name),
        help="split it into several rulebooks",
    )


def _not_utf8(name: str, data: bytes, position: int) -> Diagnostic:
    if data.startswith(_UTF_16):
        return Diagnostic(
            "R0101",
            "the file is in UTF-16, and rulebooks are in UTF-8",
            Place(name, 1, 1, 1, 1),
            help="save it as UTF-8",
        )
    before = Source(name, data[:position].decode("utf-8"))
    line, column = before.position(len(before.text))
    excerpt = data.splitlines()[line - 1].decode("utf-8", "replace").rstrip("\r\n\0")
    return Diagnostic(
        "R0101",
        f"the byte 0x{data[position]:02x} is not UTF-8",
        Place(name, line, column, line, column + 1, excerpt),
        help="save the file as UTF-8",
    )
