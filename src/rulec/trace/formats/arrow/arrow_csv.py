"""Large plain CSV files, read in blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import IO

import numpy as np
import pyarrow
from pyarrow import csv

from rulec.trace.formats.arrow.arrow_arrays import lengths_in
from rulec.trace.formats.arrow.arrow_blocks import Piece
from rulec.trace.formats.table_reader import LONGEST_ROW, Row

_BLOCK_BYTES = 1 << 22
_NEAR_BYTES = 1 << 17
_LONGEST_CELL = 1 << 17

RowsFrom = Callable[[IO[bytes], int], Iterator[Row]]


def pieces(
    stream: IO[bytes], columns: Sequence[str], number: int, rows_from: RowsFrom
) -> Iterator[Piece | Iterator[Row]]:
    """The rows of a stream from here on, as pieces for ``cut``.

    ``number`` is the line that comes next. ``rows_from`` reads the stream from a line with that
    number on row by row; it has the last word, on the first block that is not plain and the rest.
    """
    offset = stream.tell()
    for lines in _in_lines(stream):
        n_lines = _plain_lines(lines) if len(lines) <= LONGEST_ROW else None
        piece = _parsed(lines, n_lines, columns) if n_lines else None
        if piece is None:
            stream.seek(offset)
            yield rows_from(stream, number)
            return
        yield piece
        number += len(piece)
        offset += len(lines)


def _in_lines(stream: IO[bytes]) -> Iterator[bytes]:
    """Blocks of whole lines; one that is too long is cut somewhere."""
    rest: list[bytes] = []
    while block := stream.read(_BLOCK_BYTES):
        end = block.rfind(b"\n") + 1
        if end:
            yield b"".join([*rest, block[:end]])
            rest = []
        rest.append(block[end:])
        if sum(map(len, rest)) > LONGEST_ROW:
            break
    if any(rest):
        yield b"".join(rest)


def _plain_lines(lines: bytes) -> int | None:
    """The number of lines, None if Arrow and the csv module might not cut them alike."""
    if lines.startswith((b"\n", b"\r", b"\xef\xbb\xbf")) or b"\0" in lines:
        return None
    has_returns = b"\r" in lines
    if has_returns and (lines.count(b"\r") != lines.count(b"\r\n") or b"\n\r\n" in lines):
        return None
    begin, end = int(lines.startswith(b'"')), int(lines.endswith(b'"'))
    end += lines.count(b'"\r\n') if has_returns else 0
    n_quotes, n_lines = 0, int(not lines.endswith(b"\n"))
    whole = np.frombuffer(lines, np.uint8)
    # In pieces that stay near to the processor; each begins with the last byte of the one before.
    for start in range(0, len(whole), _NEAR_BYTES):
        text = whole[start : start + _NEAR_BYTES + 1]
        ends_row, quotes = text == ord("\n"), text == ord('"')
        if (ends_row[1:] & ends_row[:-1]).any():
            return None  # a blank line
        n_lines += np.count_nonzero(ends_row[:_NEAR_BYTES])
        n_quotes += np.count_nonzero(quotes[:_NEAR_BYTES])
        if n_quotes:
            separates = ends_row | (text == ord(","))
            begin += np.count_nonzero(quotes[1:] & separates[:-1])
            end += np.count_nonzero(quotes[:-1] & separates[1:])
    # Every quote begins or ends a cell.
    return n_lines if begin == end and begin + end == n_quotes else None


def _parsed(lines: bytes, n_lines: int, columns: Sequence[str]) -> Piece | None:
    """The cells as texts; None if there is something wrong with them."""
    try:
        table = csv.read_csv(
            pyarrow.BufferReader(lines),
            csv.ReadOptions(
                use_threads=False, block_size=len(lines) + 1, column_names=list(columns)
            ),
            # Lines that end within quotes are told by their number, which is a third faster.
            csv.ParseOptions(
                quote_char='"' if b'"' in lines else False,
                newlines_in_values=not lines.endswith(b"\n"),
            ),
            csv.ConvertOptions(
                # All of ASCII is UTF-8, which is seen sooner of a block than of its cells.
                check_utf8=not lines.isascii(),
                column_types=dict.fromkeys(columns, pyarrow.string()),
                null_values=[""],
                strings_can_be_null=True,
            ),
        )
    except pyarrow.ArrowException:
        return None
    (piece,) = table.combine_chunks().to_batches(max_chunksize=len(table))
    if len(piece) != n_lines:
        return None  # there are lines within quotes
    longest = max(int(lengths_in(column).max(initial=0)) for column in piece.columns)
    return piece if longest <= _LONGEST_CELL else None
