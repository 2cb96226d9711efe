"""Whatever mistakes are in a table: it is read, or refused with one message."""

import gzip

import pytest

from rulec import RulecError, read_recording
from support.builders.argoverse_files import parquet_bytes
from support.builders.track_tables import LANES, driving, table

HEAD = "track,t,x,y,type,heading,speed,length,brake_light,ego"
ROWS = [
    *driving("1", more=",car,0,10,4.5,0,1"),
    *driving("2", speed=8.0, y=3.5, more=",truck,,8,9,,0"),
    *driving("p", speed=0.0, y=-3.0, more=",pedestrian,1.5,0,,,"),
]
CARS = table(HEAD, *ROWS)


def test_a_packed_file_that_is_cut(tmp_path):
    (tmp_path / "lanes.csv").write_text(LANES)
    file = tmp_path / "cars.csv.gz"
    file.write_bytes(gzip.compress(CARS.encode())[:-20])
    with pytest.raises(RulecError, match="it is packed, and ends too soon"):
        read_recording(file, form="tracks")


def test_parquet_that_is_none(tmp_path):
    (tmp_path / "lanes.csv").write_text(LANES)
    file = tmp_path / "cars.parquet"
    file.write_bytes(b"PAR1" + b"x" * 90)
    with pytest.raises(RulecError, match="it is not Parquet"):
        read_recording(file, form="tracks")


def test_parquet_whose_names_are_no_text(tmp_path):
    (tmp_path / "lanes.csv").write_text(LANES)
    rows = [{"track": "a", "t": k / 10, "x": float(k), "y": 0.0} for k in range(9)]
    file = tmp_path / "cars.parquet"
    file.write_bytes(parquet_bytes(rows).replace(b"track", b"tr\xffck"))
    with pytest.raises(RulecError, match="it is not Parquet"):
        read_recording(file, form="tracks")
