"""TFRecord files: checksums, and records that are broken among good ones."""

import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.tfrecord import checksum, tfrecords
from support.builders.waymo_files import crc32c, record

FORM = BinaryFormat("some records", "take others", 1000)


def read(tmp_path, content):
    path = tmp_path / "some.tfrecord"
    path.write_bytes(content)
    return list(tfrecords(path, FORM))


@pytest.mark.parametrize(
    ("content", "expected"),
    # RFC 3720, B.4
    [
        (bytes(32), 0x8A9136AA),
        (b"\xff" * 32, 0x62A8AB43),
        (bytes(range(32)), 0x46DD794E),
        (bytes(range(31, -1, -1)), 0x113FDB5C),
        (b"123456789", 0xE3069283),
        (b"", 0),
    ],
)
def test_known_checksums(content, expected):
    assert checksum(content) == crc32c(content) == expected


@pytest.mark.parametrize("size", [511, 512, 513, 1024, 5000])
def test_long_contents_in_parts(size):
    content = bytes(k * k % 251 for k in range(size))
    assert checksum(content) == crc32c(content)


def test_records_one_after_the_other(tmp_path):
    first, second, third = read(tmp_path, record(b"one") + record(b"") + record(b"three"))
    assert (first.number, first.place, first.content) == (1, 12, b"one")
    assert (second.number, second.place, second.content) == (2, 31, b"")
    assert third.content == b"three"


def test_a_damaged_record_does_not_hide_the_others(tmp_path):
    damaged = bytearray(record(b"two"))
    damaged[13] ^= 1
    first, broken, last = read(tmp_path, record(b"one") + bytes(damaged) + record(b"three"))
    assert (first.content, last.content) == (b"one", b"three")
    assert isinstance(broken, RulecError)
    assert "at byte 19, record 2 is damaged: its checksum is another one" in str(broken)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (record(b"two")[:5], "the file ends within its length"),
        (b"\x01" + record(b"two")[1:], "its length is damaged"),
        (record(b"two")[:-1], "record 2 has 3 bytes, more than are left"),
        (record(b"two")[:13], "record 2 has 3 bytes, more than are left"),
        (record(bytes(1001)), "it has 1,001 bytes; at most 1,000 are read"),
    ],
)
def test_what_nothing_can_follow(tmp_path, content, why):
    first, broken = read(tmp_path, record(b"one") + content)
    assert first.content == b"one"
    assert why in str(broken)
    assert "at byte 19" in str(broken)


def test_an_empty_file(tmp_path):
    with pytest.raises(RulecError, match="it is empty"):
        read(tmp_path, b"")
