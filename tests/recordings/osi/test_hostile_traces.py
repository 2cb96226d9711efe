"""Whatever bytes a trace has: it is read, or refused in one sentence, in little memory."""

import random
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec import read_recording
from rulec.diagnostics import RulecError
from support.builders import mcap_files as mcap
from support.builders import osi_traces as osi
from support.builders.wire_bytes import varint

NASTY = [
    b"",
    b"\0",
    b"\xff" * 10,
    varint(2**63),
    struct.pack("<d", float("nan")),
    struct.pack("<d", float("inf")),
    struct.pack("<d", -1e300),
    struct.pack("<I", 2**32 - 1),
    struct.pack("<Q", 2**63),
]


def sample():
    lanes = osi.lane(1, [(0, 0), (60, 1), (100, 0)], left_line=[11], right_line=[12], left=[2])
    lanes += osi.boundary(11, [(0, 2), (100, 2)]) + osi.boundary(12, [(0, -2), (100, -2)])
    lanes += osi.lane(2, [(0, 4), (100, 4)], forward=False, right=[1], pairs=[(1, 3)])
    lanes += osi.lane(60, kind=4, forward=None, pairs=[(1, 3)])
    lanes += osi.lane(3, [(120, 0), (200, 0)])
    lanes += osi.sign(5, 52, [1], 50.0) + osi.mark(6, 17, (95, 0), [1])
    lanes += osi.mark(7, 87, (50, 0), [1], size=(0.01, 8.0, 3.0))
    return [
        osi.ground_truth(
            k * 100_000_000,
            osi.vehicle(7, 10.0 + k, 0.0, lamps={1: 3, 7: 3}),
            osi.vehicle(8, 30.0, 0.0, kind=3),
            osi.light(9, 2 + k % 3, 3, [1]),
            lanes if k == 0 else b"",
            host=7,
            country=276,
        )
        for k in range(4)
    ]


MESSAGES = sample()
FILES = {
    "some.osi": osi.trace(MESSAGES),
    "view.osi": osi.trace([osi.sensor_view(one, host=7) for one in MESSAGES]),
    "plain.mcap": mcap.recorded(MESSAGES, method=""),
    "lz4.mcap": mcap.recorded(MESSAGES, method="lz4"),
    "zstd.mcap": mcap.recorded(MESSAGES, method="zstd"),
}


def mutated(data, pick):
    """The bytes with one to four mistakes."""
    for _ in range(pick.randint(1, 4)):
        at, length = pick.randrange(len(data) + 1), pick.choice((0, 1, 1, 4, 8, 40))
        nasty = pick.choice((*NASTY, bytes([pick.randrange(256)]), data[at : at + 30]))
        data = data[:at] + nasty + data[at + length :]
    return data[: pick.randrange(len(data) + 1)] if pick.random() < 0.1 else data


@given(seed=st.integers(0, 2**32))
def test_mistakes_are_read_or_refused(tmp_path_factory, seed):
    pick = random.Random(seed)
    folder = tmp_path_factory.mktemp("mutated")
    # Each example is several files, as making a folder takes longer than reading one
    for number in range(6):
        name, data = pick.choice(list(FILES.items()))
        if name.endswith(".osi") and pick.random() < 0.5:
            # What is within a message, its size being right
            messages = list(MESSAGES)
            at = pick.randrange(len(messages))
            messages[at] = mutated(messages[at], pick)
            data = osi.trace(messages)
        else:
            data = mutated(data, pick)
        file = folder / f"{number}-{name}"
        file.write_bytes(data)
        read_or_refused(file)


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


INNER = mcap.schema(1, "osi3.GroundTruth") + mcap.channel(1, 1) + mcap.message(1, 0, MESSAGES[0])


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (mcap.MAGIC, "it ends before its data do"),
        (mcap.MAGIC + mcap.record(6, b"abc"), "a chunk ends in its head"),
        (mcap.MAGIC + struct.pack("<BQ", 6, 2**60), "a record has 1,152,921,504,606,846,976 bytes"),
        (mcap.MAGIC + struct.pack("<BQ", 6, 99), "it has been cut short"),
        (mcap.file(mcap.message(1, 0, b"")), "channel 1, which has not been described before"),
        (mcap.file(mcap.record(4, b"\1")), "a record is shorter than its kind is"),
        (mcap.file(mcap.chunk(INNER, "zstd", size=10)), "damaged or not of its size"),
        (mcap.file(mcap.chunk(INNER, "lz4", size=10**8)), "instead of 100,000,000"),
        (mcap.file(mcap.chunk(INNER, "zstd", size=2**40)), "a chunk has 1,099,511,627,776 bytes"),
        (mcap.file(mcap.chunk(INNER, "brotli")), "by another method than lz4 or zstd"),
        (mcap.file(mcap.chunk(INNER, "lz4", checksum=1)), "its checksum is not that"),
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
