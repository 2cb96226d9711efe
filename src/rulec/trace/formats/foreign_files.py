"""Files that are no traces, recognised by their first bytes."""

from __future__ import annotations

from typing import NamedTuple


class Foreign(NamedTuple):
    """Kind of a foreign file, and the way out."""

    noun: str
    help: str


_BEGINNINGS = {
    b"\x1f\x8b": Foreign("data compressed with gzip", "unpack it with `gunzip`"),
    b"\x28\xb5\x2f\xfd": Foreign("data compressed with Zstandard", "unpack it with `unzstd`"),
    b"PK\x03\x04": Foreign("a ZIP archive", "unpack it with `unzip`"),
    b"PAR1": Foreign("Parquet", "add `--format parquet`"),
    b"\xff\xfe": Foreign("text in UTF-16", "save it in UTF-8"),
    b"\xfe\xff": Foreign("text in UTF-16", "save it in UTF-8"),
}

_TEXT = frozenset(b"\t\n\r\f")


def packed(beginning: bytes) -> Foreign | None:
    """Kind of container that a file with this beginning is."""
    return next((kind for mark, kind in _BEGINNINGS.items() if beginning.startswith(mark)), None)


def foreign(beginning: bytes) -> Foreign | None:
    """Kind of file that this beginning is, if no UTF-8 text.

    The beginning is some bytes, or the first line.
    """
    result = packed(beginning)
    if result is not None:
        return result
    some = beginning[:1000]
    if _is_utf16(some):
        return Foreign("text in UTF-16", "save it in UTF-8")
    if any(byte < 32 and byte not in _TEXT for byte in some):
        return Foreign("something that is no text", "give traces as JSON Lines, CSV or Parquet")
    return None


def _is_utf16(some: bytes) -> bool:
    """Test whether nearly every other byte is 0."""
    zeros = sorted((some[::2].count(0), some[1::2].count(0)))
    return len(some) > 3 and zeros[0] == 0 and zeros[1] * 2 > 0.9 * len(some)
