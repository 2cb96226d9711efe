"""Columns of values read from given positions in JSON text."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.trace.formats.byte_words import (
    BYTES,
    Bytes,
    Places,
    Words,
    begin_with,
    short_decimals,
    words_for,
    words_from,
)
from rulec.trace.formats.table_blocks import Coded, Column, Numbers

PADDING = 64
"""The text needs this many bytes before the first value and after the last."""

_MOST_DIGITS = 15
"""Decimals of at most this many digits are exact floats, and their digits fit a float's 53 bits."""

_LONGEST_NUMBER = 17
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
    return _numbers(text, starts, ends, words)


def _truths(lengths: Places, words: Words) -> ReadColumn:
    is_true, is_false = (
        begin_with(words, word) & (lengths == len(word)) for word in (_TRUE, _FALSE)
    )
    return ReadColumn(Coded(is_true.astype(np.int8), (False, True)), is_true | is_false)


def _numbers(text: Bytes, starts: Places, ends: Places, words: Words) -> ReadColumn:
    """Numbers with few digits, converted together and exactly; others one by one."""
    lengths = ends - starts
    is_negative = begin_with(words, b"-")
    if lengths.max() <= BYTES and not is_negative.any():
        numbers, is_read = short_decimals(words[:, 0], lengths)
    else:
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
    digits = characters - np.uint8(_ZERO)
    is_inside = lengths > np.arange(width - 1, -1, -1)[:, None]
    is_digit = (digits < 10) & is_inside
    is_point = (characters == _POINT) & is_inside
    mantissa = np.zeros(len(starts), dtype=np.int64)
    behind = np.zeros(len(starts), dtype=np.int64)
    is_behind = np.zeros(len(starts), dtype=bool)
    for byte in range(width):
        mantissa = np.where(is_digit[byte], mantissa * 10 + digits[byte], mantissa)
        behind += is_behind
        is_behind |= is_point[byte]
    n_digits, n_points = is_digit.sum(axis=0), is_point.sum(axis=0)
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
    numbers = mantissa / 10.0 ** behind.clip(max=_MOST_DIGITS)
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
