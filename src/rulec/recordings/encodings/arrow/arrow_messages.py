"""The unpacked size of Arrow messages, determined before Arrow unpacks them.

See the Arrow columnar format, "Serialization and Interprocess Communication" (format version 1.5):
a file holds messages, each with metadata as a flatbuffer and a body whose buffers may be packed.
Only the stated sizes are read here; everything else is left to Arrow.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

_DICTIONARY_BATCH, _RECORD_BATCH = 2, 3
_HEADER_TYPE, _HEADER = 1, 2
_ROWS, _BUFFERS, _COMPRESSION = 0, 2, 3
_BATCH_OF_DICTIONARY = 1
_BUFFER_BYTES = 16
_MOST_BUFFERS = 100_000


class OddMessageError(Exception):
    """The metadata of a message are inconsistent."""


@dataclass(frozen=True, slots=True)
class BatchSize:
    """The stated number of rows of a batch, and the bytes that its buffers unpack to."""

    rows: int
    unpacked_bytes: int


def batch_size(metadata: bytes, body: memoryview) -> BatchSize:
    """The size of a message's batch; zero for messages of other kinds.

    Raises OddMessageError.
    """
    try:
        message = _table_at(metadata, 0)
        kind = _scalar(metadata, message, _HEADER_TYPE, "<B")
        if kind not in (_DICTIONARY_BATCH, _RECORD_BATCH):
            return BatchSize(0, 0)
        batch = _table_in(metadata, message, _HEADER)
        if kind == _DICTIONARY_BATCH:
            batch = _table_in(metadata, batch, _BATCH_OF_DICTIONARY)
        packed = _place(metadata, batch, _COMPRESSION) is not None
        sizes = sum(_buffer_sizes(metadata, batch, body, packed=packed))
        return BatchSize(_scalar(metadata, batch, _ROWS, "<q"), sizes)
    except (struct.error, IndexError):
        raise OddMessageError from None


def _buffer_sizes(metadata: bytes, batch: int, body: memoryview, *, packed: bool) -> Iterator[int]:
    at = _place(metadata, batch, _BUFFERS)
    if at is None:
        return
    start = at + _unsigned(metadata, at)
    count = _unsigned(metadata, start)
    if count > _MOST_BUFFERS:
        raise OddMessageError
    for number in range(count):
        offset, length = struct.unpack_from("<qq", metadata, start + 4 + number * _BUFFER_BYTES)
        if offset < 0 or length < 0 or offset + length > len(body):
            raise OddMessageError
        if packed and length:
            (size,) = struct.unpack_from("<q", body, offset)
            # -1: this buffer is not packed
            yield length if size == -1 else size
            if size < -1:
                raise OddMessageError
        else:
            yield length


def _table_at(data: bytes, at: int) -> int:
    return at + _unsigned(data, at)


def _unsigned(data: bytes, at: int) -> int:
    value: int = struct.unpack_from("<I", data, at)[0]
    return value


def _place(data: bytes, table: int, field: int) -> int | None:
    """The position of a flatbuffer table's field; None if the field is absent."""
    virtual = table - struct.unpack_from("<i", data, table)[0]
    if virtual < 0:
        raise OddMessageError
    (size,) = struct.unpack_from("<H", data, virtual)
    if 4 + 2 * field + 2 > size:
        return None
    (offset,) = struct.unpack_from("<H", data, virtual + 4 + 2 * field)
    return table + offset if offset else None


def _table_in(data: bytes, table: int, field: int) -> int:
    at = _place(data, table, field)
    if at is None:
        raise OddMessageError
    return _table_at(data, at)


def _scalar(data: bytes, table: int, field: int, form: str) -> int:
    at = _place(data, table, field)
    value: int = 0 if at is None else struct.unpack_from(form, data, at)[0]
    return value
