"""Whatever bytes a trace has: it is read, or refused in one sentence, in little memory."""

import struct

import pytest

from rulec import read_recording
from rulec.diagnostics import RulecError
from support.builders import mcap_files as mcap
from support.builders import osi_traces as osi

MESSAGES = osi.every_element()
FILES = {
    "some.osi": osi.trace(MESSAGES),
    "view.osi": osi.trace([osi.sensor_view(one, host=7) for one in MESSAGES]),
    "plain.mcap": mcap.recorded(MESSAGES, method=""),
    "lz4.mcap": mcap.recorded(MESSAGES, method="lz4"),
    "zstd.mcap": mcap.recorded(MESSAGES, method="zstd"),
}


def read_or_refused(file):
    try:
        recording = read_recording(file)
    except RulecError as refused:
        (found,) = refused.diagnostics
        assert found.code in ("R0610", "R0614")
        assert found.place.file == str(file)
        assert "\n" not in found.message
        assert len(found.message) < 300
        return
    assert recording.step_s > 0
    assert recording.participants
    for lanelet in recording.lanelets.values():
        assert len(lanelet.left) == len(lanelet.right) == len(lanelet.centre) > 1


@pytest.mark.parametrize("name", sorted(FILES))
def test_a_file_that_is_cut_anywhere(tmp_path, name):
    data = FILES[name]
    for end in range(0, len(data), max(len(data) // 60, 1)):
        file = tmp_path / name
        file.write_bytes(data[:end])
        read_or_refused(file)


PACKED_SHORT = struct.pack("<QQQI", 0, 0, 3, 0) + mcap.text("") + struct.pack("<Q", 9) + b"abc"
"""A chunk that is to have nine bytes, and has the three that it says to unpack to."""

INNER = mcap.schema(1, "osi3.GroundTruth") + mcap.channel(1, 1) + mcap.message(1, 0, MESSAGES[0])


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (mcap.MAGIC, "it ends before its data do"),
        (mcap.MAGIC + mcap.record(6, b"abc"), "a record is shorter than its kind is"),
        (mcap.MAGIC + struct.pack("<BQ", 6, 2**60), "a record has 1,152,921,504,606,846,976 bytes"),
        (mcap.MAGIC + struct.pack("<BQ", 6, 99), "it has been cut short"),
        (mcap.file(mcap.message(1, 0, b"")), "channel 1, which has not been described before"),
        (mcap.file(mcap.record(4, b"\1")), "a record is shorter than its kind is"),
        (mcap.file(mcap.chunk(INNER, "zstd", size=10)), "damaged or not of its size"),
        (mcap.file(mcap.chunk(INNER, "lz4", size=10**8)), "not of its size, 100,000,000 bytes"),
        (mcap.file(mcap.chunk(INNER, "zstd", size=2**40)), "a chunk has 1,099,511,627,776 bytes"),
        (mcap.file(mcap.chunk(INNER, "brotli")), "by another method than lz4 or zstd"),
        (mcap.file(mcap.chunk(INNER, "lz4", checksum=1)), "its checksum is not that"),
        (
            mcap.file(mcap.chunk(struct.pack("<BQ", 5, 2**63))),
            "a record has 9,223,372,036,854,775,808",
        ),
        (mcap.file(mcap.record(6, PACKED_SHORT)), "a record is shorter than its kind is"),
        (mcap.file(mcap.chunk(INNER[:-3])), "a record in a chunk is longer than the chunk"),
        (mcap.file(mcap.chunk(mcap.record(3, b"\1\0" + b"\xff" * 4))), "shorter than its kind"),
    ],
)
def test_what_is_no_mcap(tmp_path, data, said):
    file = tmp_path / "some.mcap"
    file.write_bytes(data)
    with pytest.raises(RulecError) as caught:
        read_recording(file)
    assert said in caught.value.diagnostics[0].message


def test_a_chunk_that_unpacks_to_a_thousand_times_its_size_is_bounded(tmp_path):
    """Ten million zeros of 1,000 bytes that say to be 1,000 are not unpacked."""
    file = tmp_path / "some.mcap"
    file.write_bytes(mcap.file(mcap.chunk(bytes(10_000_000), "zstd", size=1000)))
    assert file.stat().st_size < 5_000
    with pytest.raises(RulecError, match="damaged or not of its size"):
        read_recording(file)
