"""Lines of a stream, their locations, and recognition of files that contain no traces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import IO, NamedTuple, Protocol, cast

from rulec.diagnostics import SourceLocation

_BLOCK_BYTES = 1 << 22

_MOST_SKIPPED = 1 << 32
"""Bytes of an overlong line that are skipped; one that is longer is taken to never end."""

_MOST_SHOWN = 1 << 20
"""A longer line is not quoted in messages, not even in part."""


class _Arriving(Protocol):
    def read1(self, size: int) -> bytes: ...


def lines_as_they_come(stream: IO[bytes], longest: int) -> Iterator[list[bytes]]:
    """The lines of a stream, without their line feeds, in lists.

    Waits only while no line is complete, so that a program writing line by line into a pipe is
    answered line by line. Of a line of more than ``longest`` bytes there is only a part, longer
    than that; after a line that never ends, as in ``/dev/zero``, reading stops.
    """
    arriving = cast("_Arriving", stream)
    parts: list[bytes] = []
    size = 0
    while size <= _MOST_SKIPPED and (block := arriving.read1(_BLOCK_BYTES)):
        first, *more = block.split(b"\n")
        if size <= longest:
            parts.append(first)
        size += len(first)
        if more:
            yield [b"".join(parts), *more[:-1]]
            parts, size = [more[-1]], len(more[-1])
    if size:
        yield [b"".join(parts)]


def not_utf8(line: bytes) -> int | None:
    """The index of the first byte that is not UTF-8; None if all are."""
    try:
        line.decode()
    except UnicodeDecodeError as reason:
        return reason.start
    return None


def placed(place: SourceLocation, line: bytes, byte: int) -> SourceLocation:
    """The location of a byte in a line, with the line as excerpt."""
    column = len(line[:byte].decode("utf-8", "replace")) + 1
    text = line.decode("utf-8", "replace").rstrip("\r\0") if len(line) < _MOST_SHOWN else ""
    return replace(place, column=column, end_line=place.line, end_column=column + 1, excerpt=text)


class Foreign(NamedTuple):
    """What a foreign file is, and what to do about it."""

    noun: str
    help: str


_TEXTS = "traces are JSON Lines, CSV or Parquet, and tables of recorded traffic CSV or Parquet"

_UTF16_MARKS = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}
_UTF16 = Foreign("text in UTF-16", "save it in UTF-8")
_BEGINNINGS = {
    b"\x1f\x8b": Foreign("data compressed with gzip", "unpack it with `gunzip`"),
    b"\x28\xb5\x2f\xfd": Foreign("data compressed with Zstandard", "unpack it with `unzstd`"),
    b"BZh": Foreign("data compressed with bzip2", "unpack it with `bunzip2`"),
    b"\xfd7zXZ": Foreign("data compressed with xz", "unpack it with `unxz`"),
    b"version https://git-lfs": Foreign(
        "a Git LFS pointer", "fetch the file that it stands for with `git lfs pull`"
    ),
    b"PK\x03\x04": Foreign(
        "a ZIP archive", "unpack it with `unzip`; or, if it is an Excel file, save its sheet as CSV"
    ),
    b"\xd0\xcf\x11\xe0": Foreign("an Excel or Word file", "save its sheet as CSV"),
    b"ARROW1": Foreign("Arrow (Feather)", "write it as Parquet, as `to_parquet` of pandas does"),
    # Their first lines have no control characters, by which other binary data are known.
    b"\x89PNG": Foreign("a picture (PNG)", _TEXTS),
    b"%PDF-": Foreign("a PDF document", _TEXTS),
    b"PAR1": Foreign("Parquet", "add `--input-format parquet`"),
    **dict.fromkeys(_UTF16_MARKS, _UTF16),
}

_TEXT = frozenset(b"\t\n\r\f")


def packed(beginning: bytes) -> Foreign | None:
    """The kind of container that begins like this; None if it is none that is known."""
    return next((kind for mark, kind in _BEGINNINGS.items() if beginning.startswith(mark)), None)


def foreign(beginning: bytes) -> Foreign | None:
    """The kind of foreign file that begins like this; None for UTF-8 text."""
    some = beginning[:1000]
    kind = packed(beginning)
    if kind is None and utf16(some):
        return _UTF16
    if kind is None and any(byte < 32 and byte not in _TEXT for byte in some):
        return Foreign("binary data", _TEXTS)
    return kind


def utf16(beginning: bytes) -> str:
    """Python's name for the UTF-16 of a text that begins like this; empty if it is none.

    Without a mark at its beginning, nearly every other byte is 0.
    """
    some = beginning[:1000]
    for mark, name in _UTF16_MARKS.items():
        if some.startswith(mark):
            return name
    zeros = some[::2].count(0), some[1::2].count(0)
    if len(some) < 4 or min(zeros) or max(zeros) * 2 <= 0.9 * len(some):
        return ""
    return "utf-16-be" if zeros[0] else "utf-16-le"
