"""Protocol Buffers written by hand, as https://protobuf.dev/programming-guides/encoding/ says."""

import struct


def varint(number):
    """A number below 2^64 in groups of seven bits, the lowest first; negative ones as 64 bits."""
    number %= 1 << 64
    groups = []
    while number >= 0x80:
        groups.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*groups, number])


def field(number, wire_type, content):
    """A field with its tag; a counted one with its count."""
    count = varint(len(content)) if wire_type == 2 else b""
    return varint(number << 3 | wire_type) + count + content


def counted(number, *contents):
    """A text, some bytes, or a message of fields."""
    return field(number, 2, b"".join(contents))


def double(number, value):
    """A field with a number of 64 bits."""
    return field(number, 1, struct.pack("<d", value))


def whole(number, value):
    """A field with a whole number, or a number of an enumeration."""
    return field(number, 0, varint(value))
