"""MCAP written by hand, as https://mcap.dev/spec says."""

import struct
import zlib

import zstandard
from lz4 import frame as lz4

MAGIC = b"\x89MCAP0\r\n"
PACKED = {
    "": lambda data: data,
    "lz4": lz4.compress,
    "zstd": zstandard.compress,
}


def record(kind, content):
    """A record with its kind and size."""
    return struct.pack("<BQ", kind, len(content)) + content


def text(words):
    """A text with its size."""
    return struct.pack("<I", len(words.encode())) + words.encode()


def schema(number, name):
    return record(3, struct.pack("<H", number) + text(name) + text("protobuf") + text(""))


def channel(number, schema_number, topic="/truth", encoding="protobuf"):
    head = struct.pack("<HH", number, schema_number)
    return record(4, head + text(topic) + text(encoding) + text(""))


def message(number, time, data):
    return record(5, struct.pack("<HIQQ", number, 0, time, time) + data)


def chunk(records, method="", size=None, checksum=None):
    """Records packed by a method; its size and checksum are true unless they are given."""
    packed = PACKED.get(method, PACKED[""])(records)
    head = struct.pack(
        "<QQQI",
        0,
        0,
        len(records) if size is None else size,
        zlib.crc32(records) if checksum is None else checksum,
    )
    return record(6, head + text(method) + struct.pack("<Q", len(packed)) + packed)


def file(*records):
    """The bytes of a file, without an index."""
    header, end, footer = (
        record(1, text("") + text("")),
        record(15, bytes(4)),
        record(2, bytes(20)),
    )
    return MAGIC + header + b"".join(records) + end + footer + MAGIC


def recorded(messages, name="osi3.GroundTruth", method="zstd"):
    """The bytes of a file with messages of one kind, the nth at the nth millisecond."""
    inner = schema(1, name) + channel(1, 1)
    inner += b"".join(message(1, 1_000_000 * k, data) for k, data in enumerate(messages))
    return file(chunk(inner, method))
