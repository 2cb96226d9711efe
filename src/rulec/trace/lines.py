"""Lines of a stream, as many at a time as have arrived."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO, Protocol, cast

_BLOCK_BYTES = 1 << 22


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
