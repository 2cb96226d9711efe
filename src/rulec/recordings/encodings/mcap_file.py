"""MCAP files as a stream of messages, safe against malicious files.

See https://mcap.dev/spec, version 0. The library knows what records consist of; sizes are limited
here. The index at the end is not used: a file is read from beginning to end.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import IO, Any, NamedTuple
from zlib import crc32

from lz4.frame import LZ4FrameDecompressor
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.records import Channel, Chunk, Message, Schema
from mcap.writer import MCAP0_MAGIC
from zstandard import ZstdDecompressor, ZstdError

from rulec.files.read_files import opened
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short

MAGIC = MCAP0_MAGIC
"""The bytes at the beginning and the end of a file."""

LARGEST_RECORD = 100_000_000
"""Limit on the bytes of a record or an unpacked chunk; recorders begin a chunk per megabyte."""

MOST_CHANNELS = 10_000

_MESSAGE, _CHUNK, _DATA_END = 5, 6, 15
_HEAD = struct.Struct("<BQ")
_PARTS: Mapping[int, Callable[[ReadDataStream], Any]] = {
    3: Schema.read,
    4: Channel.read,
    _CHUNK: Chunk.read,
}


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


class _Content(BytesIO):
    """The content of a record, which has all that is read of it."""

    def read(self, size: int | None = -1, /) -> bytes:
        data = super().read(size)
        if size is not None and len(data) < size:
            raise EndOfFile
        return data


def read_messages(path: Path, form: FileFormat) -> Iterator[McapMessage]:
    """The messages in the order of the file. Raises RulecError R0610, R0701 during iteration."""
    contents = _Contents(path, form)
    with opened(path) as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise form.refused(path, "it does not begin as MCAP does", 0)
        for kind, content, place in contents.records(stream):
            if kind == _DATA_END:
                return
            yield from contents.messages(kind, content, place)
    why = "it ends before its data do; it has been cut short, or is still being written"
    raise form.refused(path, why)


@dataclass(slots=True)
class _Contents:
    """The schemas and channels read so far."""

    path: Path
    form: FileFormat
    schemas: dict[int, str] = field(default_factory=dict)
    channels: dict[int, McapChannel] = field(default_factory=dict)

    def records(
        self, stream: IO[bytes], chunk: int | None = None
    ) -> Iterator[tuple[int, bytes, int]]:
        """Kind, content and place of each record, in a ``chunk`` that of the chunk."""
        at = len(MAGIC)
        while head := stream.read(_HEAD.size):
            kind, size = _HEAD.unpack(head.ljust(_HEAD.size, b"\0"))
            place = at if chunk is None else chunk
            if size > LARGEST_RECORD:
                why = f"a record has {size:,} bytes: at most {LARGEST_RECORD:,} are read"
                raise self.form.refused(self.path, why, place)
            content = stream.read(size)
            if len(head) + len(content) < _HEAD.size + size:
                why = "a record begins that has more bytes than are left; it has been cut short"
                if chunk is not None:
                    why = "a record in a chunk is longer than the chunk"
                raise self.form.refused(self.path, why, place)
            yield kind, content, place
            at += _HEAD.size + size

    def messages(self, kind: int, content: bytes, place: int) -> Iterator[McapMessage]:
        """The messages in a record; schemas and channels are stored."""
        stream = ReadDataStream(_Content(content))
        try:
            record: Any = None
            if kind == _MESSAGE:
                record = Message.read(stream, len(content))
            elif read := _PARTS.get(kind):
                record = read(stream)
        except (EndOfFile, struct.error, UnicodeDecodeError, OverflowError):
            why = "a record is shorter than its kind is, or its text is not UTF-8"
            raise self.form.refused(self.path, why, place) from None
        match record:
            case Message():
                channel = self.channels.get(record.channel_id)
                if channel is None:
                    why = f"a message is of channel {record.channel_id}"
                    why += ", which has not been described before"
                    raise self.form.refused(self.path, why, place)
                yield McapMessage(channel, record.log_time, record.data, place)
            case Schema():
                self.schemas[record.id] = short(record.name)
            case Channel():
                topic, encoding = short(record.topic), short(record.message_encoding)
                schema = self.schemas.get(record.schema_id, "")
                self.channels[record.id] = McapChannel(record.id, topic, encoding, schema)
            case Chunk():
                whole = BytesIO(self._unpacked(record, place))
                for inner, part, _ in self.records(whole, place):
                    if inner != _CHUNK:
                        yield from self.messages(inner, part, place)
        if len(self.schemas) + len(self.channels) > MOST_CHANNELS:
            why = f"it has more than {MOST_CHANNELS:,} channels and schemas"
            raise self.form.refused(self.path, why, place)

    def _unpacked(self, chunk: Chunk, place: int) -> bytes:
        """The bytes in a chunk, which are unpacked no further than its size."""
        size, method, packed = chunk.uncompressed_size, chunk.compression, chunk.data
        if size > LARGEST_RECORD:
            why = f"a chunk has {size:,} bytes: at most {LARGEST_RECORD:,} are read"
            raise self.form.refused(self.path, why, place)
        why = ""
        try:
            if method == "lz4":
                packed = LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
            elif method == "zstd":
                packed = ZstdDecompressor().stream_reader(packed).read(size + 1)
            elif method:
                why = "it is packed by another method than lz4 or zstd"
        except (RuntimeError, ZstdError):
            why = f"it is packed ({method}), and damaged"
        if len(packed) != size:
            why = why or f"it is damaged or not of its size, {size:,} bytes"
        elif chunk.uncompressed_crc and crc32(packed) != chunk.uncompressed_crc:
            why = why or "its checksum is not that of its content"
        if why:
            raise self.form.refused(self.path, f"a chunk cannot be unpacked: {why}", place)
        return packed
