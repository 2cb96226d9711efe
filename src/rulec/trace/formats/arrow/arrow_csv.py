"""Large plain CSV files, read in blocks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import IO, TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pyarrow import csv, types

from rulec.trace.formats.arrow.arrow_arrays import ends_in, lengths_in
from rulec.trace.formats.arrow.arrow_blocks import Piece, WholeTraces, start_of_last
from rulec.trace.formats.table_reader import LONGEST_ROW, OWN, TRACE, Row

if TYPE_CHECKING:
    from io import BufferedReader

Bytes = NDArray[np.uint8]

_BLOCK_BYTES = 1 << 22
_NEAR_BYTES = 1 << 17
_LONGEST_CELL = 1 << 17

_SMALL_PART = 1 << 4
"""A trace with less than 1/16 of a block's rows at its end waits for the next: fewer copies."""

_CELLS_TOGETHER = 1 << 6
_CELLS_LOOKED_AT = 1 << 4

_LF, _CR, _COMMA, _QUOTE = b'\n\r,"'
_MARK = b"\xef\xbb\xbf"

_TRUTHS = frozenset({"true", "false"})

RowsFrom = Callable[[IO[bytes], int], Iterator[Row]]

Types = Mapping[str, Any]
"""The Arrow type of each column."""


def pieces(
    stream: IO[bytes], columns: Sequence[str], number: int, rows_from: RowsFrom
) -> Iterator[Piece | WholeTraces | Iterator[Row]]:
    """The rows of a stream from its current position, as pieces for ``cut``.

    ``number`` is the number of the next line. ``rows_from`` reads row by row from a numbered line
    on; it takes over at the first block that is not plain, and decides whether anything is wrong.
    """
    offset = stream.tell()
    texts: Types = dict.fromkeys(columns, pyarrow.string())
    kinds, tells_kinds = texts, True
    blocks, at = _Blocks(stream), columns.index(TRACE)
    while len(lines := blocks.read()):
        plain = _plain_lines(lines) if len(lines) <= LONGEST_ROW else None
        piece = _parsed(lines, plain, kinds) if plain else None
        if plain and piece is None and kinds is not texts:
            kinds, tells_kinds = texts, False
            piece = _parsed(lines, plain, texts)
        if piece is None:
            stream.seek(offset)
            yield rows_from(stream, number)
            return
        if tells_kinds and kinds is texts:
            kinds, tells_kinds = {**texts, **_truths_in(piece)}, False
        n_rows, size = len(piece), len(lines)
        start = start_of_last(piece.column(at))
        if not blocks.is_last and (n_rows - start) * _SMALL_PART < n_rows:
            size = _start_of_line(lines, n_rows - start)
            n_rows, piece = start, WholeTraces(piece.slice(0, start))
        yield piece
        blocks.drop(size)
        number += n_rows
        offset += size


class _Blocks:
    """Blocks of whole lines of a stream, one after another in the same memory.

    Allocating memory for each would take noticeable time. A block is valid until the next is read.
    """

    def __init__(self, stream: IO[bytes]) -> None:
        self.is_last = False
        self._stream = cast("BufferedReader", stream)
        self._whole = np.empty(LONGEST_ROW + 2 * _BLOCK_BYTES, dtype=np.uint8)
        self._begin = self._end = 0

    def read(self) -> Bytes:
        """The next block, empty at the end; a line that is too long is cut at some point."""
        rest = self._whole[self._begin : self._end].copy()
        self._whole[: len(rest)] = rest
        self._begin, self._end, end = 0, len(rest), 0
        while not (end or self.is_last or self._end > LONGEST_ROW):
            before = self._end
            room = self._whole[before : before + _BLOCK_BYTES].data
            self._end += self._stream.readinto(room)
            self.is_last = self._end == before
            end = _end_of_lines(self._whole[: self._end], before)
        return self._whole[: end or self._end]

    def drop(self, size: int) -> None:
        """Let the next block begin after ``size`` bytes of this one."""
        self._begin = size


def _end_of_lines(text: Bytes, least: int) -> int:
    """The end of the last line that ends after ``least``; 0 if none does."""
    for size in (_NEAR_BYTES, len(text)):
        begin = max(least, len(text) - size)
        ends = np.flatnonzero(text[begin:] == _LF)
        if len(ends):
            return begin + int(ends[-1]) + 1
    return 0


def _start_of_line(text: Bytes, count: int) -> int:
    """Where the last ``count`` lines begin, all of which end with a line feed."""
    begin, ends = len(text), np.zeros(0, dtype=np.intp)
    while len(ends) <= count:
        begin = max(begin - _NEAR_BYTES, 0)
        ends = begin + np.flatnonzero(text[begin:] == _LF)
    return int(ends[-1 - count]) + 1


class _Plain(NamedTuple):
    """The number of lines in a block, whether it has quotes, and whether it is ASCII only."""

    n_lines: int
    has_quotes: bool
    is_ascii: bool


def _plain_lines(lines: Bytes) -> _Plain | None:
    """Properties of a block; None if Arrow and the csv module might split its lines differently.

    Blank lines are detected later, from the number of rows.
    """
    head = lines[:3].tobytes()
    if head.startswith((b"\n", b"\r", _MARK)):
        return None
    begin, end = int(lines[0] == _QUOTE), int(lines[-1] == _QUOTE)
    n_quotes, n_lines = 0, int(lines[-1] != _LF)
    has_returns, is_ascii = False, True
    # In pieces that fit the processor's cache; each overlaps the next by one byte.
    for start in range(0, len(lines), _NEAR_BYTES):
        text = lines[start : start + _NEAR_BYTES + 1]
        if not text.min():
            return None
        is_ascii = is_ascii and bool(text.max() < 1 << 7)
        has_returns = has_returns or bool((text == _CR).any())
        ends_row, quotes = text == _LF, text == _QUOTE
        n_lines += np.count_nonzero(ends_row[:_NEAR_BYTES])
        n_quotes += np.count_nonzero(quotes[:_NEAR_BYTES])
        if n_quotes:
            separates = ends_row | (text == _COMMA)
            begin += np.count_nonzero(quotes[1:] & separates[:-1])
            end += np.count_nonzero(quotes[:-1] & separates[1:])
    if has_returns:
        whole = lines.tobytes()
        if whole.count(b"\r") != whole.count(b"\r\n"):
            return None
        end += whole.count(b'"\r\n')
    # Every quote begins or ends a cell.
    are_plain = begin == end and begin + end == n_quotes
    return _Plain(n_lines, n_quotes > 0, is_ascii) if are_plain else None


def _parsed(lines: Bytes, plain: _Plain, kinds: Types) -> Piece | None:
    """The block's cells in columns of these types; None if something is wrong with them."""
    try:
        table = csv.read_csv(
            pyarrow.BufferReader(pyarrow.py_buffer(lines)),
            csv.ReadOptions(use_threads=False, block_size=len(lines) + 1, column_names=list(kinds)),
            # Line ends within quotes are detected from the number of rows, which is a third faster.
            csv.ParseOptions(
                quote_char='"' if plain.has_quotes else False,
                newlines_in_values=bool(lines[-1] != _LF),
            ),
            csv.ConvertOptions(
                # ASCII is UTF-8, and checking a block is faster than checking its cells.
                check_utf8=not plain.is_ascii,
                column_types=kinds,
                null_values=[""],
                true_values=["true"],
                false_values=["false"],
                strings_can_be_null=True,
            ),
        )
    except pyarrow.ArrowException:
        return None
    (piece,) = table.combine_chunks().to_batches(max_chunksize=len(table))
    if len(piece) != plain.n_lines:
        return None  # there are line ends within quotes, or blank lines
    return piece if all(map(_are_short, piece.columns)) else None


def _are_short(column: Any) -> bool:
    """Whether no cell of a column is longer than the csv module accepts."""
    if not types.is_string(column.type):
        return True
    ends = ends_in(column)
    # Usually even many cells together are not that long, which is faster to check.
    together = np.append(ends[::_CELLS_TOGETHER], ends[-1:])
    return any(np.diff(some).max(initial=0) <= _LONGEST_CELL for some in (together, ends))


def _truths_in(piece: Piece) -> Types:
    """The Boolean type for each column that seems to contain only true and false."""
    names = zip(piece.schema.names, piece.columns, strict=True)
    values = ((name, column) for name, column in names if name not in OWN)
    return {name: pyarrow.bool_() for name, column in values if _seem_truths(column)}


def _seem_truths(column: Any) -> bool:
    given = np.flatnonzero(lengths_in(column))
    looked_at = given[:: len(given) // _CELLS_LOOKED_AT + 1].tolist()
    return bool(looked_at) and all(column[row].as_py() in _TRUTHS for row in looked_at)
