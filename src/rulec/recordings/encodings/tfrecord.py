"""TensorFlow record files (TFRecord): a sequence of lengths, checksums and bytes.

See https://www.tensorflow.org/tutorials/load_data/tfrecord: a length of 8 bytes with its checksum,
then that many bytes with theirs. Checksums are CRC-32C (Castagnoli; RFC 3720, B.4), rotated and
shifted.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy import uint32
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files.read_files import opened
from rulec.recordings.encodings.file_format import BinaryFormat

_HEAD = struct.Struct("<QI")
_FOOT = struct.Struct("<I")
HEAD_BYTES = _HEAD.size
_REVERSED_CASTAGNOLI = 0x82F63B78
_MASK = 0xA282EAD8
_ALL_BITS = 0xFFFFFFFF
_LANES = 512
"""The number of parts of a long record whose checksums are computed in parallel."""


class TfRecord(NamedTuple):
    """A record: its number from 1, the byte at which its content begins, and the content."""

    number: int
    place: int
    content: bytes


def tfrecords(path: Path, form: BinaryFormat) -> Iterator[TfRecord | RulecError]:
    """The records of a file, with an error (R0610) in place of each broken one.

    After a broken length no further record can be found, so that error is the last item. Raises
    RulecError R0610 for an empty file, R0701 for one that cannot be read.
    """
    with opened(path) as stream:
        number = place = 0
        while head := stream.read(HEAD_BYTES):
            number += 1
            begin, place = place, place + HEAD_BYTES
            why = _broken_head(head, form.largest_bytes)
            if why:
                yield form.refused(path, f"record {number} begins, but {why}", begin)
                return
            length, _ = _HEAD.unpack(head)
            content, foot = stream.read(length), stream.read(_FOOT.size)
            if len(content) < length or len(foot) < _FOOT.size:
                why = f"record {number} has {length:,} bytes, more than are left; it was cut short"
                yield form.refused(path, why, begin)
                return
            if _FOOT.unpack(foot)[0] != masked_checksum(content):
                why = f"record {number} is damaged: its checksum is another one"
                yield form.refused(path, why, begin)
            else:
                yield TfRecord(number, place, content)
            place += length + _FOOT.size
        if not number:
            raise form.refused(path, "it is empty")


def _broken_head(head: bytes, most: int) -> str:
    if len(head) < HEAD_BYTES:
        return "the file ends within its length; it was cut short"
    length, check = _HEAD.unpack(head)
    if check != masked_checksum(head[:8]):
        return "its length is damaged: the checksum is another one"
    return f"it has {length:,} bytes; at most {most:,} are read" if length > most else ""


def masked_checksum(content: bytes) -> int:
    """The masked checksum of some bytes, as record files contain it."""
    check = checksum(content)
    return (((check >> 15) | (check << 17)) + _MASK) & _ALL_BITS


def checksum(content: bytes) -> int:
    """The CRC-32C of some bytes."""
    size = len(content) // _LANES
    state = _ALL_BITS
    if size:
        state = _checksum_of_parts(content[: size * _LANES], size, state)
    table = _table().tolist()
    for byte in content[size * _LANES :]:
        state = table[(state ^ byte) & 0xFF] ^ (state >> 8)
    return state ^ _ALL_BITS


def _checksum_of_parts(content: bytes, size: int, state: int) -> int:
    """The register after ``_LANES`` parts of equal size.

    The register is linear in itself and in the bytes. So all parts start with 0, in parallel, and
    then each adds the effect of its predecessor's register, shifted by ``size`` bytes of 0.
    """
    columns = np.frombuffer(content, dtype=np.uint8).reshape(_LANES, size).T.astype(uint32)
    registers = np.zeros(_LANES, dtype=uint32)
    registers[0] = state
    table = _table()
    for column in columns:
        registers = table[(registers ^ column) & 0xFF] ^ (registers >> 8)
    shifted = _shifted_bits(size)
    total = int(registers[0])
    for own in registers[1:].tolist():
        moved = 0
        for bit, image in enumerate(shifted):
            if total >> bit & 1:
                moved ^= image
        total = moved ^ own
    return total


def _shifted_bits(size: int) -> list[int]:
    """What each bit of the register becomes after ``size`` bytes of 0."""
    table = _table()
    bits = np.uint32(1) << np.arange(32, dtype=uint32)
    for _ in range(size):
        bits = table[bits & 0xFF] ^ (bits >> 8)
    images: list[int] = bits.tolist()
    return images


@cache
def _table() -> NDArray[uint32]:
    table = np.arange(256, dtype=uint32)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ uint32(_REVERSED_CASTAGNOLI), table >> 1)
    return table
