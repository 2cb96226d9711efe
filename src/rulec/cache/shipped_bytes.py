"""Caches that ship with rulec: bytes by keys made from their sources.

A kind's file begins with a digest of the code that made it. If that code has changed, as it may in
a checkout, or the file is damaged, nothing of it is used. Then come a dictionary for zlib with what
entries have in common, the keys, and the entries.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from itertools import accumulate
from pathlib import Path

from rulec.resources import code_digest, rulebooks_folder

_BEGINNING = b"rulec shipped 1\n"
_DIGEST = sha256().digest_size
_KEY, _NUMBER = 16, 4
"""Bytes of a key, and of a number (a count of bytes or entries, or the end of an entry)."""
_COMMON = 1 << 15
"""The window of zlib in bytes; a longer dictionary would be of no use."""


class ShippedBytes:
    """The entries of a file: key -> bytes, unpacked on request."""

    def __init__(self, entries: Mapping[bytes, bytes], common: bytes = b"") -> None:
        self._entries = entries
        self._common = common

    @property
    def keys(self) -> set[bytes]:
        """The keys of all entries."""
        return {*self._entries}

    def recall(self, key: bytes) -> bytes | None:
        """The entry under a key; None if there is none or it is damaged."""
        packed = self._entries.get(key)
        if packed is None:
            return None
        unpacking = zlib.decompressobj(zdict=self._common)
        try:
            data = unpacking.decompress(packed)
        except zlib.error:
            return None
        return data if unpacking.eof else None


_NOTHING = ShippedBytes({})


def shipped_file(kind: str) -> Path:
    """The path of the entries of a kind."""
    return rulebooks_folder() / f"shipped.{kind}"


def shipped_key(*parts: str) -> bytes:
    """The key of the entry made from these texts."""
    seen = sha256()
    for part in parts:
        data = part.encode("utf-8", "surrogatepass")
        seen.update(f"{len(data)}\0".encode())
        seen.update(data)
    return seen.digest()[:_KEY]


@cache
def shipped(kind: str, makers: tuple[str, ...]) -> ShippedBytes:
    """The entries of a kind; none if ``makers`` (files and folders of code) have changed."""
    try:
        data = shipped_file(kind).read_bytes()
    except OSError:
        return _NOTHING
    start = len(_BEGINNING) + _DIGEST
    if data[:start] != _BEGINNING + code_digest(makers):
        return _NOTHING
    common_end = start + 2 * _NUMBER + _number(data, start)
    common = data[start + _NUMBER : common_end - _NUMBER]
    body = common_end + _number(data, common_end - _NUMBER) * (_KEY + _NUMBER)
    entries: dict[bytes, bytes] = {}
    before = body
    for place in range(common_end, body, _KEY + _NUMBER):
        end = body + _number(data, place + _KEY)
        entries[data[place : place + _KEY]] = data[before:end]
        before = end
    return ShippedBytes(entries, common) if before == len(data) else _NOTHING


def shipped_text(entries: Mapping[bytes, bytes], makers: Sequence[str]) -> bytes:
    """The content of a file with these entries, in the format that ``shipped`` reads."""
    keys = sorted(entries)
    common = _in_common([entries[key] for key in keys])
    packed = []
    for key in keys:
        packing = zlib.compressobj(9, zdict=common)
        packed.append(packing.compress(entries[key]) + packing.flush())
    ends = accumulate(map(len, packed))
    index = [key + _bytes(end) for key, end in zip(keys, ends, strict=True)]
    head = [_BEGINNING, code_digest(tuple(makers)), _bytes(len(common)), common, _bytes(len(keys))]
    return b"".join([*head, *index, *packed])


def _in_common(entries: Sequence[bytes]) -> bytes:
    """A sample of the shorter entries, not longer than the window of zlib."""
    short = [data for data in entries if len(data) < _COMMON // 8]
    every = max(1, sum(map(len, short)) // _COMMON)
    return b"".join(short[::every])[-_COMMON:]


def _number(data: bytes, place: int) -> int:
    return int.from_bytes(data[place : place + _NUMBER], "big")


def _bytes(number: int) -> bytes:
    return number.to_bytes(_NUMBER, "big")
