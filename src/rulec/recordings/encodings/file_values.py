"""Numbers and words in files, whatever the encoding."""

from __future__ import annotations

from collections.abc import Collection

LARGEST = 1e8
"""Limit on numbers in a file, coordinates (m) included: larger than the earth's circumference."""


def number_in(text: str) -> float:
    """The number in a text. Raises ValueError.

    Python would also read ``1_0`` and the digits of other scripts, which no format has: whatever
    wrote them meant something else.
    """
    if "_" in text or not text.strip().isascii():
        raise ValueError(text)
    return float(text)


def numbers_in(texts: Collection[str]) -> list[float]:
    """The numbers in texts, checked together. Raises ValueError as ``number_in`` does."""
    whole = "".join(texts)
    is_plain = whole.isascii() and "_" not in whole
    return list(map(float if is_plain else number_in, texts))


def short(text: str) -> str:
    """Text of a file for use in a message: short, and without control characters."""
    return "".join(c if c.isprintable() else "?" for c in text[:40])
