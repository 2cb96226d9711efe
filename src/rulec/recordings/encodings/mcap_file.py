"""MCAP files as a stream of messages, safe against malicious files.

See https://mcap.dev/spec, version 0. The only dependencies are the compression libraries for
chunks. The index at the end is not used: a file is read from beginning to end.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, NamedTuple
from zlib import crc32

import cramjam

from rulec.files.read_files import opened
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short

MAGIC = b"\x89MCAP0\r\n"
"""The bytes at the beginning and the end of a file."""

LARGEST_RECORD = 100_000_000
"""Limit on the bytes of a record or an unpacked chunk; recorders begin a chunk per megabyte."""

MOST_CHANNELS = 10_000

_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 3, 4, 5, 6, 15
_HEAD = struct.Struct("<BQ")
_SHORT, _WORD, _LONG = struct.Struct("<H"), struct.Struct("<I"), struct.Struct("<Q")
_MESSAGE_HEAD = struct.Struct("<HIQQ")
_CHUNK_HEAD = struct.Struct("<QQQI")


class McapChannel(NamedTuple):
    """A channel: its topic, the encoding of its messages, and the name of their schema."""

    id: int
    topic: str
    encoding: str
    schema: str


class McapMessage(NamedTuple):
    """A message, the byte where it (or the chunk that holds it) begins, and its time in ns."""

    channel: McapChannel
    time: int
    data: bytes
    place: int


class _Record(NamedTuple):
    kind: int
    content: bytes
    place: int


def read_messages(path: Path, form: FileFormat) -> Iterator[McapMessage]:
    """The messages in the order of the file. Raises RulecError R0610, R0701 during iteration."""
    contents = _Contents(path, form)
    with opened(path) as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise form.refused(path, "it does not begin as MCAP does", 0)
        for record in _records(stream, path, form):
            if record.kind == _DATA_END:
                return
            if record.kind != _CHUNK:
                yield from contents.add(record)
                continue
            for inner in contents.chunk(record):
                yield from contents.add(inner)
    why = "it ends before its data do; it has been cut short, or is still being written"
    raise form.refused(path, why)


def _records(stream: IO[bytes], path: Path, form: FileFormat) -> Iterator[_Record]:
    place = len(MAGIC)
    while len(head := stream.read(_HEAD.size)) == _HEAD.size:
        kind, size = _HEAD.unpack(head)
        if size > LARGEST_RECORD:
            why = f"a record has {size:,} bytes: at most {LARGEST_RECORD:,} are read"
            raise form.refused(path, why, place)
        content = stream.read(size)
        if len(content) < size:
            why = "a record begins that has more bytes than are left; it has been cut short"
            raise form.refused(path, why, place)
        yield _Record(kind, content, place)
        place += len(head) + size


@dataclass(slots=True)
class _Contents:
    """The schemas and channels read so far."""

    path: Path
    form: FileFormat
    schemas: dict[int, str] = field(default_factory=dict)
    channels: dict[int, McapChannel] = field(default_factory=dict)

    def add(self, record: _Record) -> Iterator[McapMessage]:
        """The message in a record, if it holds one; schemas and channels are stored."""
        try:
            if record.kind == _MESSAGE:
                yield self._message(record)
            elif record.kind == _SCHEMA:
                self._schema(record.content)
            elif record.kind == _CHANNEL:
                self._channel(record.content)
        except (struct.error, UnicodeDecodeError):
            why = "a record is shorter than its kind is, or its text is not UTF-8"
            raise self.form.refused(self.path, why, record.place) from None
        if len(self.schemas) + len(self.channels) > MOST_CHANNELS:
            why = f"it has more than {MOST_CHANNELS:,} channels and schemas"
            raise self.form.refused(self.path, why, record.place)

    def chunk(self, record: _Record) -> Iterator[_Record]:
        """The records of a chunk."""
        content, place = record.content, record.place
        try:
            _, _, size, checksum = _CHUNK_HEAD.unpack_from(content)
            method, at = _text(content, _CHUNK_HEAD.size)
            (count,) = _LONG.unpack_from(content, at)
        except (struct.error, UnicodeDecodeError):
            raise self.form.refused(self.path, "a chunk ends in its head", place) from None
        packed = content[at + _LONG.size :]
        if size > LARGEST_RECORD or count != len(packed):
            why = f"a chunk has {size:,} bytes, packed {count:,} of {len(packed):,}"
            expected = f"expected at most {LARGEST_RECORD:,}, and all of them"
            raise self.form.refused(self.path, why, place, expected=expected)
        try:
            whole = _unpacked(packed, method, size)
        except ValueError as problem:
            why = f"a chunk cannot be unpacked: {problem}"
            raise self.form.refused(self.path, why, place) from None
        if checksum and crc32(whole) != checksum:
            why = "a chunk is damaged: its checksum is not that of its content"
            raise self.form.refused(self.path, why, place)
        at = 0
        while at < size:
            if size - at < _HEAD.size or (at + _HEAD.size + _HEAD.unpack_from(whole, at)[1] > size):
                why = "a record in a chunk is longer than the chunk"
                raise self.form.refused(self.path, why, place)
            kind, length = _HEAD.unpack_from(whole, at)
            at += _HEAD.size
            yield _Record(kind, whole[at : at + length], place)
            at += length

    def _message(self, record: _Record) -> McapMessage:
        number, _, time, _ = _MESSAGE_HEAD.unpack_from(record.content)
        channel = self.channels.get(number)
        if channel is None:
            why = f"a message is of channel {number}, which has not been described before"
            raise self.form.refused(self.path, why, record.place)
        return McapMessage(channel, time, record.content[_MESSAGE_HEAD.size :], record.place)

    def _schema(self, content: bytes) -> None:
        (number,) = _SHORT.unpack_from(content)
        self.schemas[number] = short(_text(content, _SHORT.size)[0])

    def _channel(self, content: bytes) -> None:
        (number,), (schema,) = _SHORT.unpack_from(content), _SHORT.unpack_from(content, 2)
        topic, at = _text(content, 2 * _SHORT.size)
        encoding, _ = _text(content, at)
        name = self.schemas.get(schema, "")
        self.channels[number] = McapChannel(number, short(topic), short(encoding), name)


def _text(content: bytes, at: int) -> tuple[str, int]:
    """The length-prefixed text at a position, and the position after it."""
    (size,) = _WORD.unpack_from(content, at)
    begin = at + _WORD.size
    if size > len(content) - begin:
        raise struct.error
    return content[begin : begin + size].decode(), begin + size


def _unpacked(packed: bytes, method: str, size: int) -> bytes:
    """The unpacked bytes of a chunk; ``method`` is ``lz4`` (frames), ``zstd``, or empty for none.

    Raises ValueError if the chunk is damaged, has another size, or uses another method.
    """
    if not method:
        content = packed
    elif method in ("lz4", "zstd"):
        buffer = bytearray(size)
        library = cramjam.lz4 if method == "lz4" else cramjam.zstd
        try:
            # It never writes beyond the buffer, whatever size the chunk states
            count = library.decompress_into(packed, buffer)
        except cramjam.DecompressionError:
            raise ValueError(f"it is packed ({method}), and damaged or not of its size") from None
        content = bytes(buffer[:count])
    else:
        raise ValueError("it is packed by another method than lz4 or zstd")
    if len(content) != size:
        raise ValueError(f"it has {len(content):,} bytes instead of {size:,}")
    return content
