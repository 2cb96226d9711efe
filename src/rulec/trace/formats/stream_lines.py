"""Lines of a stream as they arrive, with their locations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import IO, Protocol, cast

from rulec.diagnostics import SourceLocation

_BLOCK_BYTES = 1 << 22

_MOST_SHOWN = 1 << 20
"""A longer line is not shown, not even in part."""


class _Arriving(Protocol):
    def read1(self, size: int) -> bytes: ...


def lines_as_they_come(stream: IO[bytes], longest: int) -> Iterator[list[bytes]]:
    """The lines of a stream, without their line feeds, in lists.

    It waits only while no line is complete, so who writes into a pipe line by line is answered line
    by line. Of a line of more than ``longest`` bytes there is a part that is longer than that.
    """
    arriving = cast("_Arriving", stream)
    parts: list[bytes] = []
    size = 0
    while block := arriving.read1(_BLOCK_BYTES):
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
    """The place of the first byte that is not UTF-8."""
    try:
        line.decode()
    except UnicodeDecodeError as reason:
        return reason.start
    return None


def placed(place: SourceLocation, line: bytes, byte: int) -> SourceLocation:
    """The place of a line's byte, with the line."""
    column = len(line[:byte].decode("utf-8", "replace")) + 1
    text = line.decode("utf-8", "replace").rstrip("\r\0") if len(line) < _MOST_SHOWN else ""
    return replace(place, column=column, end_line=place.line, end_column=column + 1, excerpt=text)
