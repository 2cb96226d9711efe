"""A text's bytes taken eight at a time as integers, which NumPy compares and computes at once.

The first byte of a word is the lowest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]
Words = NDArray[np.uint64]

BYTES: int = 8
"""Bytes per word."""

_POWERS_OF_TEN = 10.0 ** np.arange(BYTES + 1)
_ZEROS, _POINTS, _SIXES, _ONES, _HIGH, _LOW = (
    np.uint64(byte * 0x0101_0101_0101_0101) for byte in (0x30, 0x2E, 0x06, 0x01, 0xF0, 0x7F)
)
_ALL = ~np.uint64(0)
_POINT_AT = np.uint64(0x80) << np.arange(0, 64, 8, dtype=np.uint64)
"""Words in which only the highest bit of one byte is set, from the first byte to the last."""


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


def short_decimals(
    words: NDArray[np.uint64], lengths: Places
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The values of unsigned numbers of one to eight bytes, and a mask of those valid in JSON.

    Each word begins with its number. All digits are combined at once: first neighbours, then pairs,
    then fours.
    """
    unused = (BYTES * (BYTES - lengths)).astype(np.uint64)
    first = words & np.uint64(0xFF)
    # Shift the numbers to the end of their words, after zeros.
    words = (words << unused) | (_ZEROS & ~(_ALL << unused))
    # Set the highest bit of each byte that is a decimal point.
    others = words ^ _POINTS
    points = ~(((others & _LOW) + _LOW) | others | _LOW)
    has_point = points != 0
    behind = np.where(has_point, BYTES - 1 - np.searchsorted(_POINT_AT, points), 0)
    before = lengths - behind - has_point
    # Move the digits before the point by one byte, over the point.
    lower = (points >> np.uint64(7)) - np.uint64(1)
    higher = ~((points << np.uint64(1)) - np.uint64(1))
    moved = (words & higher) | ((words & lower) << np.uint64(8)) | np.uint64(0x30)
    digits = np.where(has_point, moved, words)
    is_read = (
        (digits & _HIGH == _ZEROS)
        & ((digits + _SIXES) & _HIGH == _ZEROS)
        & (points & (points - np.uint64(1)) == 0)
        & (before > 0)
        & (behind >= has_point)
        & ~((first == 0x30) & (before > 1))
    )
    digits -= _ZEROS
    digits = digits * np.uint64(10) + (digits >> np.uint64(8))
    pairs = np.uint64(0x0000_00FF_0000_00FF)
    digits = (digits & pairs) * np.uint64(100 + (1_000_000 << 32)) + (
        (digits >> np.uint64(16)) & pairs
    ) * np.uint64(1 + (10_000 << 32))
    mantissa = (digits >> np.uint64(32)).astype(np.int64)
    return mantissa / _POWERS_OF_TEN.take(behind), is_read
