"""Whatever mistakes are in a table: it is read, or refused with one message."""

import gzip
import os
import random

import pytest

from rulec import RulecError, read_recording
from support.builders.track_tables import LANES, driving, highd, table
from support.generators.mutated_files import BYTES, WORDS

HEAD = "track,t,x,y,type,heading,speed,length,brake_light,ego"
ROWS = [
    *driving("1", more=",car,0,10,4.5,0,1"),
    *driving("2", speed=8.0, y=3.5, more=",truck,,8,9,,0"),
    *driving("p", speed=0.0, y=-3.0, more=",pedestrian,1.5,0,,,"),
]
TEXTS = {"cars.csv": table(HEAD, *ROWS), "lanes.csv": LANES}
TRIES = 20_000 if os.environ.get("RULEC_TEST_PROFILE") == "long" else 300
CODES = {"R0610", "R0614", "R0615"}


def mutated(text, pick):
    """The bytes of a table with one to three mistakes."""
    rows = [line.split(",") for line in text.splitlines()]
    for _ in range(pick.randint(1, 3)):
        row = pick.choice(rows)
        at = pick.randrange(len(row)) if row else 0
        match pick.randrange(6):
            case 0:
                rows.remove(row)
            case 1:
                rows.insert(pick.randrange(len(rows)), list(row))
            case 2:
                del row[at : at + 1]
            case _:
                row[at : at + 1] = [pick.choice(WORDS)]
        rows = rows or [[""]]
    data = "\n".join(map(",".join, rows)).encode()
    match pick.randrange(6):
        case 0:
            return data[: pick.randrange(len(data) + 1)]
        case 1:
            at = pick.randrange(len(data) + 1)
            return data[:at] + pick.choice((*BYTES, b'"', b";", b"\x1f\x8b")) + data[at + 1 :]
    return data


def check(file):
    """The map is always there, and the format given: heads may be broken, too."""
    try:
        recording = read_recording(file, form="tracks")
    except RulecError as refused:
        (found,) = refused.diagnostics
        assert found.code in CODES
        assert "\n" not in found.message
        assert len(found.message) < 400
    else:
        assert recording.step_s > 0
        assert all(len(one.states) for one in recording.participants)


@pytest.mark.parametrize("name", TEXTS)
def test_a_mistake_is_read_or_refused(tmp_path, name):
    pick = random.Random(5)
    for other, text in TEXTS.items():
        (tmp_path / other).write_text(text)
    for _ in range(TRIES):
        (tmp_path / name).write_bytes(mutated(TEXTS[name], pick))
        check(tmp_path / "cars.csv")


def test_mistakes_in_files_of_a_data_set(tmp_path):
    pick = random.Random(7)
    file = highd(tmp_path, [(2, 0.0, 26.0, 30.0, 5), (1, 90.0, 9.5, 36.0, 5)])
    files = {name: (tmp_path / name).read_text() for name in
             ("01_tracks.csv", "01_tracksMeta.csv", "01_recordingMeta.csv")}  # fmt: skip
    for _ in range(TRIES // 3):
        for name, text in files.items():
            (tmp_path / name).write_text(text)
        broken = pick.choice(list(files))
        (tmp_path / broken).write_bytes(mutated(files[broken], pick))
        try:
            assert read_recording(file, form="highd").participants
        except RulecError as refused:
            (found,) = refused.diagnostics
            assert found.code in CODES


def test_a_packed_file_that_is_cut(tmp_path):
    (tmp_path / "lanes.csv").write_text(LANES)
    file = tmp_path / "cars.csv.gz"
    file.write_bytes(gzip.compress(TEXTS["cars.csv"].encode())[:-20])
    with pytest.raises(RulecError, match="it is packed, and ends too soon"):
        read_recording(file, form="tracks")


def test_parquet_that_is_none(tmp_path):
    (tmp_path / "lanes.csv").write_text(LANES)
    file = tmp_path / "cars.parquet"
    file.write_bytes(b"PAR1" + b"x" * 90)
    with pytest.raises(RulecError, match="it is no Parquet"):
        read_recording(file, form="tracks")
