"""One trace of very many states, or rows of very many cells: a limit, and the rest goes on."""

import io

import pytest

from rulec.diagnostics import RulecError
from rulec.resource_limits import in_force
from rulec.trace.formats import csv_table, table_reader
from rulec.trace.formats.trace_files import read_chunks

JSON = "\n".join(
    [
        '{"id": "few", "states": [{"p": true}, {"p": true}]}',
        '{"id": "many", "states": [' + ", ".join(['{"p": true}'] * 9) + "]}",
        '{"id": "torn", "states": [' + ", ".join(['{"p": true}'] * 9),
        '{"id": "last", "states": [{"p": true}]}',
    ]
)
ROWS = [("few", 2), ("many", 9), ("last", 1)]
CSV = "trace,step,p\n" + "".join(f"{name},{n},true\n" for name, count in ROWS for n in range(count))


def read(data, form):
    data = data if isinstance(data, bytes) else data.encode()
    chunks = read_chunks(io.BytesIO(data), "t", form)
    return [
        one.diagnostics[0] if isinstance(one, RulecError) else one.id
        for chunk in chunks
        for one in chunk
    ]


def parquet_of(text):
    pytest.importorskip("pyarrow")
    # Arrow, which may not be installed.
    from pyarrow import csv, parquet

    stream = io.BytesIO()
    parquet.write_table(csv.read_csv(io.BytesIO(text.encode())), stream)
    return stream.getvalue()


def test_a_line_of_too_many_states_is_refused_and_the_others_are_read():
    with in_force(["states=7"]):
        few, many, torn, last = read(JSON, "jsonl")
    assert (few, last) == ("few", "last")
    for refused, line in ((many, 2), (torn, 3)):
        assert (refused.code, refused.place.line) == ("R0718", line)
        assert refused.message.startswith("more than 7 rows or JSON objects")
        assert "--limit states=NUMBER" in refused.help
    with in_force(["states=20"]):
        assert read(JSON, "jsonl")[:2] == ["few", "many"]


def test_a_table_s_trace_of_too_many_rows_is_refused_and_the_others_are_read():
    with in_force(["states=8"]):
        few, many, last = read(CSV, "csv")
    assert (few, last) == ("few", "last")
    assert (many.code, many.place.line) == ("R0718", 4)
    with in_force(["states=9"]):
        assert read(CSV, "csv") == ["few", "many", "last"]


def test_a_trace_that_goes_on_through_blocks_is_refused_where_it_is_too_long(monkeypatch):
    pytest.importorskip("pyarrow")
    data = parquet_of(CSV)
    # As above.
    from rulec.trace.formats.arrow import parquet

    monkeypatch.setattr(parquet, "_ROWS_AT_ONCE", 3)
    with in_force(["states=5"]):
        few, many = read(data, "parquet")
    assert few == "few"
    assert (many.code, many.place.line) == ("R0718", 3)
    assert read(data, "parquet") == ["few", "many", "last"]


@pytest.mark.parametrize("large", [False, True], ids=["row by row", "in blocks"])
@pytest.mark.parametrize(
    "row", ["a,0," + "x" * 3000, "a,0," + "," * 3000, "a,0," + '"x\n",' * 600], ids=repr
)
def test_a_row_of_csv_has_an_end(row, large, monkeypatch):
    pytest.importorskip("pyarrow")
    # As above.
    from rulec.trace.formats.arrow import arrow_csv

    for module in (table_reader, arrow_csv):
        monkeypatch.setattr(module, "LONGEST_ROW", 2000)
    if large:
        monkeypatch.setattr(csv_table, "LARGE_BYTES", 0)
    refused = read(f"trace,step,p\nfew,0,true\n{row}\nlast,0,true\n", "csv")[-1]
    assert (refused.code, refused.place.line) == ("R0509", 3)
    assert "a row has more than" in refused.message


def test_a_cell_of_parquet_has_an_end():
    pyarrow = pytest.importorskip("pyarrow")
    # As above.
    from pyarrow import parquet

    stream = io.BytesIO()
    cell = pyarrow.array(["x" * 70_000_000])
    parquet.write_table(
        pyarrow.table({"trace": ["a"], "step": [0], "p": cell}), stream, compression="zstd"
    )
    assert len(stream.getvalue()) < 100_000
    (refused,) = read(stream.getvalue(), "parquet")
    assert (refused.code, refused.place.file) == ("R0509", "t")
    assert "bytes unpacked" in refused.message


def test_many_columns_are_few_enough():
    names = [f"p{number}" for number in range(200_000)]
    head, row = ",".join(names), ",".join(["true"] * len(names))
    ((trace,),) = read_chunks(io.BytesIO(f"trace,step,{head}\na,0,{row}\n".encode()), "t", "csv")
    assert trace.states[0].keys() == set(names)
