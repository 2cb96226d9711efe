"""Tables in Parquet and Feather files: what is read, and what is refused before it is unpacked."""

import builtins
import struct
from contextlib import suppress

import numpy as np
import pyarrow
import pytest
from pyarrow import feather, parquet

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.arrow import arrow_tables
from rulec.recordings.encodings.arrow.arrow_tables import (
    OddMessageError,
    Wanted,
    batch_size,
    read_table,
)
from rulec.recordings.encodings.file_format import FileFormat

FORM = FileFormat("a table", "it has rows", 10_000_000)
WANTED = Wanted(numbers=("x",), whole=("n",), texts=("t",), optional=frozenset({"t"}))
TABLE = pyarrow.table({"x": [1.5, 2.0], "n": [3, 4], "t": ["a", "b"], "more": [None, None]})


def rows_of(column):
    return [column.names[code] for code in column.codes.tolist()]


def as_parquet(path, table):
    parquet.write_table(table, path)


def as_feather(path, table):
    feather.write_feather(table, path)


def as_plain_feather(path, table):
    feather.write_feather(table, path, compression="uncompressed")


def as_zstd_feather(path, table):
    feather.write_feather(table, path, compression="zstd")


WRITERS = (as_parquet, as_feather, as_plain_feather, as_zstd_feather)


@pytest.fixture(params=WRITERS, ids=lambda writer: writer.__name__)
def written(request, tmp_path):
    def write(table):
        path = tmp_path / "file"
        request.param(path, table)
        return path

    return write


def refusal(path, wanted=WANTED):
    with pytest.raises(RulecError) as caught:
        read_table(path, FORM, wanted)
    (found,) = caught.value.diagnostics
    assert found.place.file == str(path)
    return found


def test_columns_are_read_as_they_are(written):
    table = read_table(written(TABLE), FORM, WANTED)
    assert table.rows == 2
    assert table.numbers["x"].tolist() == [1.5, 2.0]
    assert table.whole["n"].tolist() == [3, 4]
    assert rows_of(table.texts["t"]) == ["a", "b"]


def test_a_table_of_several_pieces_is_one(tmp_path):
    path = tmp_path / "file"
    with pyarrow.ipc.new_file(path, TABLE.schema) as sink:
        for piece in (TABLE, TABLE.slice(1), TABLE.slice(0, 0)):
            sink.write_table(piece)
    table = read_table(path, FORM, WANTED)
    assert rows_of(table.texts["t"]) == ["a", "b", "b"]
    assert table.whole["n"].tolist() == [3, 4, 4]


def test_texts_may_be_numbers_in_a_dictionary(written):
    texts = pyarrow.array(["b", "a", "b"]).dictionary_encode()
    table = pyarrow.table({"x": [1.0] * 3, "n": [1] * 3, "t": texts})
    assert rows_of(read_table(written(table), FORM, WANTED).texts["t"]) == ["b", "a", "b"]


def test_a_table_may_have_no_rows_and_lack_what_is_optional(written):
    table = read_table(written(TABLE.slice(0, 0).drop_columns("t")), FORM, WANTED)
    assert (table.rows, table.texts) == (0, {})


@pytest.mark.parametrize(
    ("column", "values", "why"),
    [
        ("x", [1.0, np.nan], "`x` is nan"),
        ("x", [np.inf, 1.0], "`x` is inf"),
        ("x", [1.0, 1e9], "`x` is 1e+09"),
        ("x", ["1", "2"], "its column `x` is of type string"),
        ("n", [1.5, 2.5], "its column `n` is of type double"),
        ("t", [1, 2], "its column `t` is of type int64"),
        ("t", ["a", "b" * 201], "longer than 200"),
        ("n", [None, 1], "`n` has no value"),
        ("t", [None, "a"], "`t` has no value"),
    ],
)
def test_what_a_column_must_not_hold(written, column, values, why):
    names = TABLE.column_names
    table = TABLE.set_column(names.index(column), column, pyarrow.array(values))
    assert why in refusal(written(table)).message


def test_a_row_is_named_by_its_number(written):
    table = TABLE.set_column(0, "x", pyarrow.array([1.0, np.nan]))
    assert refusal(written(table)).place.line == 2


def test_a_column_must_be_there(written):
    assert "no column `n`" in refusal(written(TABLE.drop_columns("n"))).message


def test_zeros_that_unpack_to_gigabytes_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(arrow_tables, "MOST_BYTES", 1_000_000)
    path = tmp_path / "file"
    count = 200_000
    table = pyarrow.table({"x": np.zeros(count), "n": np.zeros(count, dtype=int)})
    for write in (as_feather, as_zstd_feather):
        write(path, table)
        assert path.stat().st_size < 50_000
        assert "too large" in refusal(path).message
    parquet.write_table(table, path, use_dictionary=False)
    assert "too large" in refusal(path).message


def test_too_many_rows_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(arrow_tables, "MOST_ROWS", 1)
    for write in WRITERS:
        write(tmp_path / "file", TABLE)
        assert "2 rows" in refusal(tmp_path / "file").message


def test_too_many_cells_are_refused(tmp_path, monkeypatch):
    """Rows that are all alike take no bytes, and each column its own memory."""
    path = tmp_path / "file"
    as_parquet(path, TABLE)
    monkeypatch.setattr(arrow_tables, "MOST_CELLS", 2 * len(WANTED.names) - 1)
    assert "2 rows is too large" in refusal(path).message


def test_a_file_may_be_too_large(tmp_path):
    path = tmp_path / "file"
    path.write_bytes(bytes(10_000_001))
    assert "too large" in refusal(path).message


@pytest.mark.parametrize("data", [b"", b"PAR1", b"PAR1" * 99, b"ARROW1\0\0", b"FEA1", b"x,y\n1,2"])
def test_what_is_none_is_refused(tmp_path, data):
    path = tmp_path / "file"
    path.write_bytes(data)
    assert refusal(path).code == "R0610"


def test_every_cut_is_refused_or_leaves_all(tmp_path):
    for write in WRITERS:
        path = tmp_path / "file"
        write(path, TABLE)
        whole = path.read_bytes()
        for end in range(0, len(whole), 13):
            path.write_bytes(whole[:end])
            # If only Feather's table of contents is missing, nothing is
            with suppress(RulecError):
                assert read_table(path, FORM, WANTED).rows == 2
                assert b"PAR1" not in whole


@pytest.mark.parametrize("metadata", [b"", b"\0" * 8, b"\xff" * 64, struct.pack("<I", 1 << 31)])
def test_odd_metadata_are_no_message(metadata):
    with suppress(OddMessageError):
        assert batch_size(metadata, memoryview(b"")).rows == 0


def test_without_arrow_it_says_what_to_install(tmp_path, monkeypatch):
    as_parquet(tmp_path / "file", TABLE)
    real = builtins.__import__

    def without(name, *args, **more):
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return real(name, *args, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    found = refusal(tmp_path / "file")
    assert found.code == "R0706"
    assert "[parquet]'`" in found.help


def test_a_stream_is_told_from_a_file(tmp_path):
    path = tmp_path / "file.arrow"
    with pyarrow.ipc.new_stream(path, TABLE.schema) as stream:
        stream.write_table(TABLE)
    found = refusal(path)
    assert found.message.endswith("it is a stream of Arrow's, not a file of Arrow's")
    assert "new_file" in found.help
