"""Columns of values read from given positions in JSON text.

A text's bytes are taken eight at a time as integers, which NumPy compares at once. The first byte
of a word is the lowest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.trace.formats.table_blocks import Coded, Column, Numbers

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]
Words = NDArray[np.uint64]

BYTES: int = 8
"""Bytes per word."""


def words_for(width: int) -> int:
    """The number of words that hold ``width`` bytes."""
    return -(-width // BYTES)


def words_from(text: Bytes, starts: Places, count: int) -> Words:
    """``count`` words from each start on, as (starts, words); arbitrary beyond the text."""
    size = max(count, 1) * BYTES
    windows = np.ndarray((len(text) - size + 1,), f"V{size}", text, strides=(1,))
    # ``take`` would first copy all windows.
    words: Words = windows[starts.clip(0, len(windows) - 1)].view("<u8")
    return words.reshape(len(starts), size // BYTES)


def end_as_before(words: Words, width: int) -> NDArray[np.bool_]:
    """Mask of rows, but for the first, whose last ``width`` bytes equal those of the row before."""
    same = np.ones(max(len(words) - 1, 0), dtype=bool)
    masks = np.frombuffer((b"\xff" * width).rjust(BYTES * words.shape[1], b"\0"), "<u8")
    for place, mask in enumerate(masks):
        same &= (words[1:, place] ^ words[:-1, place]) & mask == 0
    return same


def begin_with(words: Words, written: bytes) -> NDArray[np.bool_]:
    """Mask of the rows of words that begin with these bytes."""
    same = np.ones(len(words), dtype=bool)
    masks, parts = _word_of(b"\xff" * len(written)), _word_of(written)
    for place, (mask, part) in enumerate(zip(masks, parts, strict=True)):
        same &= words[:, place] & mask == part
    return same


def _word_of(written: bytes) -> Words:
    return np.frombuffer(written + bytes(-len(written) % BYTES), "<u8")


PADDING = 64
"""The text needs this many bytes before the first value and after the last."""

_MOST_DIGITS = 15
"""Decimals of at most this many digits are exact floats, and their digits fit a float's 53 bits."""

_LONGEST_NUMBER = 17
_FEW_DIGITS = 9
"""So many fit into 32 bits."""

_TENS = 10 ** np.arange(_LONGEST_NUMBER, dtype=np.int64)
_LONGEST_WRITTEN = 24
"""Python writes no number with more characters."""

_LONGEST_TEXT = PADDING
_MOST_TEXTS = 32
"""In a column with more distinct texts, the rest is left to be read one by one."""

_TINY = 1e-290
_ZERO, _POINT, _MINUS, _QUOTE = b'0.-"'
_TRUE, _FALSE = b"true", b"false"


@dataclass(frozen=True, slots=True, eq=False)
class ReadColumn:
    """A column and a mask of the values that were ``read``; the others are arbitrary."""

    column: Column
    read: NDArray[np.bool_]


def bytes_from(text: Bytes, starts: Places, width: int) -> NDArray[np.bytes_]:
    """``width`` bytes from each start, arbitrary outside of ``text``, which has no null bytes."""
    windows = np.ndarray((len(text) - width + 1,), f"S{width}", text, strides=(1,))
    # ``take`` would first copy all windows.
    taken: NDArray[np.bytes_] = windows[starts.clip(0, len(windows) - 1)]
    return taken


def column_words(text: Bytes, starts: Places, ends: Places, before: int) -> Words:
    """For each value the ``before`` words that precede it, then the words that contain it."""
    longest = int((ends - starts).max().clip(1, _LONGEST_TEXT))
    return words_from(text, starts - BYTES * before, before + words_for(longest))


def read_values(text: Bytes, starts: Places, ends: Places, words: Words) -> ReadColumn:
    """The values of a column that are all Booleans, all numbers or all texts; others are not read.

    ``words`` are those of ``column_words`` from the values on.
    """
    first = text[starts[0]]
    if first == _QUOTE:
        return _texts(text, starts, ends, words)
    if first in (_TRUE[0], _FALSE[0]):
        return _truths(ends - starts, words)
    return _numbers(text, starts, ends)


def _truths(lengths: Places, words: Words) -> ReadColumn:
    is_true, is_false = (
        begin_with(words, word) & (lengths == len(word)) for word in (_TRUE, _FALSE)
    )
    return ReadColumn(Coded(is_true.astype(np.int8), (False, True)), is_true | is_false)


def _numbers(text: Bytes, starts: Places, ends: Places) -> ReadColumn:
    """Numbers with few digits, converted together and exactly; others one by one."""
    lengths = ends - starts
    is_negative = text[starts] == _MINUS
    numbers, is_read = _decimals(text, starts, ends, is_negative)
    for place in np.flatnonzero(~is_read & (lengths <= _LONGEST_WRITTEN)).tolist():
        number = _own(bytes(text[starts[place] : ends[place]]))
        if number is not None:
            numbers[place], is_read[place] = number, True
    return ReadColumn(Numbers(numbers, is_read), is_read)


def _decimals(
    text: Bytes, starts: Places, ends: Places, is_negative: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    lengths = ends - starts
    width = min(int(lengths.max()), _LONGEST_NUMBER)
    # One row per byte position, aligned at the end, so that digits of one weight are adjacent.
    rows = bytes_from(text, ends - width, width).view(np.uint8).reshape(-1, width)
    characters = np.ascontiguousarray(rows.T)
    is_inside = lengths > np.arange(width - 1, -1, -1)[:, None]
    digits = characters - np.uint8(_ZERO)
    is_digit = (digits < 10) & is_inside
    is_point = (characters == _POINT) & is_inside
    digits *= is_digit
    mantissa = np.zeros(len(starts), dtype=np.int32 if width <= _FEW_DIGITS else np.int64)
    behind = np.zeros(len(starts), dtype=np.int8)
    for byte in range(width):
        mantissa *= 10
        mantissa += digits[byte]
        behind += is_point[byte] * np.int8(width - 1 - byte)
    n_digits, n_points = (
        np.add.reduce(flags, axis=0, dtype=np.int8) for flags in (is_digit, is_point)
    )
    # The point counted as a digit of 0: what is before it moves by one. As that 0 follows it, it is
    # the whole number nearest to the quotient; dividing integers would take longer.
    tens = _TENS.take(behind, mode="clip")
    before_point = np.rint(mantissa / (10 * tens)) * (n_points > 0)
    mantissa = mantissa - before_point.astype(np.int64) * (9 * tens)
    before = n_digits - behind
    leads_with_zero = (text[starts + is_negative] == _ZERO) & (before > 1)
    is_read = (
        (n_digits + n_points + is_negative == lengths)
        & (n_digits <= _MOST_DIGITS)
        & (n_points <= 1)
        & (before > 0)
        & (behind >= n_points)
        & ~leads_with_zero
        & ~(is_negative & (mantissa == 0))
    )
    numbers = mantissa / tens
    np.negative(numbers, out=numbers, where=is_negative)
    return numbers, is_read


def _own(written: bytes) -> float | None:
    """The number if Python writes its float the same way; None for anything unusual."""
    try:
        number = float(written)
    except ValueError:
        return None
    # What Python writes is valid JSON, except for infinity and NaN.
    is_own = repr(number).encode() == written and abs(number) > _TINY
    return number if is_own and number - number == 0 else None


def _texts(text: Bytes, starts: Places, ends: Places, words: Words) -> ReadColumn:
    """Texts of which only a few are distinct."""
    lengths = ends - starts
    codes = np.full(len(starts), -1, dtype=np.int64)
    values: list[str] = []
    left = np.flatnonzero(lengths <= _LONGEST_TEXT)
    lengths, words = lengths[left], words[left]
    while len(left) and len(values) < _MOST_TEXTS:
        written = text[starts[left[0]] : ends[left[0]]].tobytes()
        alike = begin_with(words, written) & (lengths == len(written))
        codes[left[alike]] = _code(written, values)
        left, lengths, words = left[~alike], lengths[~alike], words[~alike]
    return ReadColumn(Coded(codes.clip(min=0), values), codes >= 0)


_NO_TEXT = -2


def _code(written: bytes, values: list[str]) -> int:
    """The index of a new text in ``values``, or ``_NO_TEXT`` if it is no plain JSON string."""
    inner = written[1:-1]
    if len(written) < 2 or written[:1] + written[-1:] != b'""' or b'"' in inner:
        return _NO_TEXT
    try:
        values.append(inner.decode())
    except UnicodeDecodeError:
        return _NO_TEXT
    return len(values) - 1
