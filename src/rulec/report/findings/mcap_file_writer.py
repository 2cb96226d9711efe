"""MCAP files with messages in JSON, after https://mcap.dev/spec, version 0.

One chunk without compression, with its index, so that viewers can jump to a moment.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import IO

_MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK = 1, 2, 3, 4, 5, 6
_MESSAGE_INDEX, _CHUNK_INDEX, _STATISTICS, _METADATA = 7, 8, 11, 12
_METADATA_INDEX, _SUMMARY_OFFSET, _DATA_END = 13, 14, 15


@dataclass(frozen=True, slots=True)
class JsonChannel:
    """A topic, the name of its messages' type, and that type's JSON schema."""

    topic: str
    type: str
    schema: str


@dataclass(frozen=True, slots=True)
class TimedMessage:
    """A message as JSON with its time in ns; ``channel`` is the index of its channel."""

    channel: int
    time_ns: int
    text: str


def write_mcap(
    stream: IO[bytes],
    library: str,
    channels: tuple[JsonChannel, ...],
    messages: Iterable[TimedMessage],
    metadata: Mapping[str, Mapping[str, str]],
) -> None:
    """Write a whole file, with the messages sorted by time."""
    in_order = sorted(messages, key=lambda message: message.time_ns)
    out = _Counted(stream)
    out.write(_MAGIC + _record(_HEADER, _text("") + _text(library)))
    definitions = b"".join(
        _record(
            _SCHEMA,
            struct.pack("<H", number)
            + _text(channel.type)
            + _text("jsonschema")
            + _prefixed(channel.schema.encode()),
        )
        + _record(
            _CHANNEL,
            struct.pack("<HH", number, number) + _text(channel.topic) + _text("json") + _map({}),
        )
        for number, channel in enumerate(channels, 1)
    )
    chunk_index = _write_chunk(out, definitions, in_order) if in_order else b""
    metadata_indexes = b""
    for name, values in metadata.items():
        at = out.written
        out.write(_record(_METADATA, _text(name) + _map(values)))
        place = struct.pack("<QQ", at, out.written - at)
        metadata_indexes += _record(_METADATA_INDEX, place + _text(name))
    out.write(_record(_DATA_END, struct.pack("<I", 0)))
    groups = (
        (_SCHEMA, definitions),
        (_STATISTICS, _statistics(len(channels), in_order, len(metadata))),
        (_CHUNK_INDEX, chunk_index),
        (_METADATA_INDEX, metadata_indexes),
    )
    _write_summary(out, groups)


def _write_chunk(out: _Counted, definitions: bytes, messages: list[TimedMessage]) -> bytes:
    """Write the chunk with its message indexes; return the chunk index record."""
    content = bytearray(definitions)
    indexes: dict[int, list[tuple[int, int]]] = {}
    numbers: dict[int, int] = {}
    for message in messages:
        number = message.channel + 1
        indexes.setdefault(number, []).append((message.time_ns, len(content)))
        sequence = numbers[number] = numbers.get(number, -1) + 1
        head = struct.pack("<HIQQ", number, sequence, message.time_ns, message.time_ns)
        content += _record(_MESSAGE, head + message.text.encode("utf-8", "backslashreplace"))
    begin, end = messages[0].time_ns, messages[-1].time_ns
    data = bytes(content)
    chunk_at = out.written
    head = struct.pack("<QQQI", begin, end, len(data), zlib.crc32(data)) + _text("")
    out.write(_record(_CHUNK, head + struct.pack("<Q", len(data)) + data))
    chunk_length = out.written - chunk_at
    index_at = out.written
    places = b""
    for number, entries in indexes.items():
        places += struct.pack("<HQ", number, out.written)
        packed = b"".join(struct.pack("<QQ", *entry) for entry in entries)
        out.write(_record(_MESSAGE_INDEX, struct.pack("<H", number) + _prefixed(packed)))
    return _record(
        _CHUNK_INDEX,
        struct.pack("<QQQQ", begin, end, chunk_at, chunk_length)
        + _prefixed(places)
        + struct.pack("<Q", out.written - index_at)
        + _text("")
        + struct.pack("<QQ", len(data), len(data)),
    )


def _statistics(channels: int, messages: list[TimedMessage], metadata: int) -> bytes:
    times = (messages[0].time_ns, messages[-1].time_ns) if messages else (0, 0)
    counts: dict[int, int] = {}
    for message in messages:
        counts[message.channel + 1] = counts.get(message.channel + 1, 0) + 1
    packed = b"".join(struct.pack("<HQ", *count) for count in counts.items())
    numbers = (len(messages), channels, channels, 0, metadata, int(bool(messages)), *times)
    return _record(_STATISTICS, struct.pack("<QHIIIIQQ", *numbers) + _prefixed(packed))


def _write_summary(out: _Counted, groups: tuple[tuple[int, bytes], ...]) -> None:
    """Write the summary section, with the offsets of its groups."""
    start = out.written
    offsets = b""
    for kind, records in groups:
        if records:
            place = struct.pack("<BQQ", kind, out.written, len(records))
            # Schemas and channels are in one group; mixed groups get no offset record.
            offsets += b"" if kind == _SCHEMA else _record(_SUMMARY_OFFSET, place)
            out.write(records)
    offsets_at = out.written if offsets else 0
    out.write(offsets)
    out.write(_record(_FOOTER, struct.pack("<QQI", start, offsets_at, 0)) + _MAGIC)


class _Counted:
    """A stream with the number of bytes written."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self.written = 0

    def write(self, data: bytes) -> None:
        self._stream.write(data)
        self.written += len(data)


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def _prefixed(data: bytes) -> bytes:
    return struct.pack("<I", len(data)) + data


def _text(text: str) -> bytes:
    return _prefixed(text.encode("utf-8", "backslashreplace"))


def _map(values: Mapping[str, str]) -> bytes:
    return _prefixed(b"".join(_text(name) + _text(value) for name, value in values.items()))
