"""The header line of a CSV file: names of columns and their delimiter."""

from __future__ import annotations

import zlib

from rulec.recordings.encodings.file_values import number_in
from rulec.trace.formats.stream_lines import utf16

PARQUET = (".parquet", ".pq")
"""Suffixes of Parquet files."""

PARQUET_MARK = b"PAR1"
PACKED = b"\x1f\x8b"
LONGEST_LINE = 1 << 16
_SEPARATORS = ",;\t"


def names_in(head: bytes) -> tuple[str, ...]:
    """The names in the first line of a CSV file, in lower case; none if it is not text.

    Text in UTF-16 has some, too: whoever reads the file then says how to save it.
    """
    if head.startswith(PACKED):
        try:
            head = zlib.decompressobj(zlib.MAX_WBITS | 16).decompress(head, LONGEST_LINE)
        except zlib.error:
            return ()
    if kind := utf16(head):
        head = head.decode(kind, errors="replace").removeprefix("\ufeff").encode()
    line = head.removeprefix(b"\xef\xbb\xbf").partition(b"\n")[0]
    if b"\0" in line or line.lstrip()[:1] in (b"{", b"[", b"<"):
        return ()
    text = line.decode("utf-8", errors="replace").strip()
    mark = separator_of(text)
    cells = text.split() if mark == " " else text.split(mark)
    return tuple(cell.strip().strip('"').casefold() for cell in cells)


def is_parquet(name: str, beginning: bytes) -> bool:
    """Whether a table's first bytes or name are those of a Parquet file."""
    return beginning.startswith(PARQUET_MARK) or name.lower().endswith(PARQUET)


def separator_of(head: str) -> str:
    """The delimiter between the names of columns; a blank if there is no other."""
    counts = {mark: head.count(mark) for mark in _SEPARATORS}
    most = max(_SEPARATORS, key=lambda mark: counts[mark])
    return most if counts[most] else " "


def is_number(text: str) -> bool:
    """Whether a text is a number."""
    try:
        number_in(text)
    except ValueError:
        return False
    return True
