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
    """The CRC-32C of some bytes.

    The register is linear in itself and in the bytes. So each byte gives a register of its own, and
    two neighbours become one by shifting the first as far as the second reaches, at each level
    twice as far.
    """
    table = _table()
    registers = np.append(_ALL_BITS, table[np.frombuffer(content, dtype=np.uint8)]).astype(uint32)
    bits = np.uint32(1) << np.arange(32, dtype=uint32)
    shifted = table[bits & 0xFF] ^ (bits >> 8)
    while len(registers) > 1:
        if len(registers) % 2:
            registers = np.append(np.uint32(0), registers)
        registers = _shift(registers[::2], shifted) ^ registers[1::2]
        shifted = _shift(shifted, shifted)
    return int(registers[0]) ^ _ALL_BITS


def _shift(registers: NDArray[uint32], shifted: NDArray[uint32]) -> NDArray[uint32]:
    """Registers after some bytes of 0, by what these make of each of their bits."""
    result = np.zeros(len(registers), dtype=uint32)
    for first in range(0, 32, 8):
        # What becomes of each value of a byte, from those of its bits
        values = np.zeros(1, dtype=uint32)
        for image in shifted[first : first + 8]:
            values = np.append(values, values ^ image)
        result ^= values[registers >> first & 0xFF]
    return result


@cache
def _table() -> NDArray[uint32]:
    table = np.arange(256, dtype=uint32)
    for _ in range(8):
        table = np.where(table & 1, (table >> 1) ^ uint32(_REVERSED_CASTAGNOLI), table >> 1)
    return table
