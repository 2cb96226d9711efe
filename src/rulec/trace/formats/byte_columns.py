"""Values of JSON that stand somewhere in bytes, read as columns."""

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
"""So many bytes have to stand before the first value, and behind the last."""

_MOST_DIGITS = 15
"""Of so many digits every decimal is a float's own; so many fit into a float's 53 bits, too."""

_LONGEST_NUMBER = 17
_LONGEST_WRITTEN = 24
"""Python writes no longer number."""

_LONGEST_TEXT = PADDING
_MOST_TEXTS = 32
"""Of a column with more different texts the rest is read one by one, elsewhere."""

_TINY = 1e-290
_ZERO, _POINT, _MINUS, _QUOTE = b'0.-"'
_TRUE, _FALSE = b"true", b"false"


@dataclass(frozen=True, slots=True, eq=False)
class ReadColumn:
    """A column, and where its values are ``read``; the others are arbitrary."""

    column: Column
    read: NDArray[np.bool_]


def bytes_from(text: Bytes, starts: Places, width: int) -> NDArray[np.bytes_]:
    """So many bytes from each place on, any where there are none; ``text`` has no null in it."""
    windows = np.ndarray((len(text) - width + 1,), f"S{width}", text, strides=(1,))
    # ``take`` would first write out all windows.
    taken: NDArray[np.bytes_] = windows[starts.clip(0, len(windows) - 1)]
    return taken


def column_words(text: Bytes, starts: Places, ends: Places, before: int) -> Words:
    """The words that hold values and end with them, behind so many words that stand before."""
    longest = int((ends - starts).max().clip(1, _LONGEST_TEXT))
    return words_from(text, starts - BYTES * before, before + words_for(longest))


def read_values(text: Bytes, starts: Places, ends: Places, words: Words) -> ReadColumn:
    """The values of a column, all truth values, all numbers or all texts; others are not read.

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
    """Numbers of few digits together, exactly; others one by one."""
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
    # A column for each byte counted from the end, so that all digits of one weight lie together.
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
    """The number that is written, if its float stands for it; None for all that is unusual."""
    try:
        number = float(written)
    except ValueError:
        return None
    # What Python writes is JSON, but for what is no number.
    is_own = repr(number).encode() == written and abs(number) > _TINY
    return number if is_own and number - number == 0 else None


def _texts(text: Bytes, starts: Places, ends: Places, words: Words) -> ReadColumn:
    """Few texts that are met again and again."""
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
    """The place of one more text among ``values``, to which it is added if it is one."""
    inner = written[1:-1]
    if len(written) < 2 or written[:1] + written[-1:] != b'""' or b'"' in inner:
        return _NO_TEXT
    try:
        values.append(inner.decode())
    except UnicodeDecodeError:
        return _NO_TEXT
    return len(values) - 1
