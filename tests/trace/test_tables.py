"""Traces as CSV and as Parquet: what is read, what is refused, and that it comes back."""

import builtins
import gzip
import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.trace import Trace
from rulec.trace.formats import csv_table
from rulec.trace.formats.trace_files import (
    columns_for,
    format_of,
    is_partial,
    kinds_in,
    read_chunks,
    write_traces,
)
from rulec.vocabulary.partial_values import UNKNOWN, Interval

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

CSV = """\
trace,step,step_s,object,type,other,surface,position,speed,near,busy
t1,0,0.5,,,,R_cw,,13.9,,false
t1,0,0.5,v1,vehicle,,,b,,,
t1,1,0.5,,,,R_pc,,1e1,,true
t1,1,0.5,v1,,,,l,,,
t1,1,,p1,pedestrian,,,f,,,
t1,1,0.5,v1,vehicle,p1,,,,true,
t2,0,,,,,"R_cw",,-.5,,
"""
T1 = Trace(
    "t1",
    0.5,
    {"v1": "vehicle", "p1": "pedestrian"},
    (
        {"surface": "R_cw", "speed": 13.9, "busy": False, "position": {"v1": "b"}},
        {
            "surface": "R_pc",
            "speed": 10.0,
            "busy": True,
            "position": {"v1": "l", "p1": "f"},
            "near": {"v1": {"p1": True}},
        },
    ),
    {"p1": (1, 1)},
    ends="cut",
)
T2 = Trace("t2", 1.0, {}, ({"surface": "R_cw", "speed": -0.5},))


def read(data, form="csv"):
    return [one for chunk in read_chunks(io.BytesIO(data), "t", form) for one in chunk]


def read_text(text):
    return read(text.encode())


def problem(data, form="csv"):
    (error,) = read(data if isinstance(data, bytes) else data.encode(), form)
    assert isinstance(error, RulecError)
    (found,) = error.diagnostics
    assert found.code == "R0509"
    return found


def test_rows_are_traces():
    assert read_text(CSV) == [T1, T2]
    assert [trace.place.line for trace in read_text(CSV)] == [2, 8]


@pytest.mark.parametrize("change", ["\r\n", "\ufeff"])
def test_other_line_ends_and_a_byte_order_mark(change):
    text = change + CSV if change == "\ufeff" else CSV.replace("\n", change)
    assert read_text(text) == [T1, T2]


def test_an_object_may_be_in_any_rows_between_its_first_and_last():
    (trace,) = read_text(
        "trace,step,object,type,p\nt,0,v,car,true\nt,1,,,\nt,2,v,car,true\nt,3,,,\n"
    )
    assert trace.present == {"v": (0, 2)}
    assert trace.states == ({"p": {"v": True}}, {}, {"p": {"v": True}}, {})


def test_what_is_not_known():
    head = "trace,step,object,type,ends,told,speed,gap,gap.from,gap.to\n"
    (trace,) = read_text(head + "t,0,,,cut,gap speed,?,,,\nt,0,v,car,,,,,1,2.5\nt,1,v,,,,,?,,\n")
    assert trace.states == (
        {"speed": UNKNOWN, "gap": {"v": Interval(1, 2.5)}},
        {"gap": {"v": UNKNOWN}},
    )
    assert (trace.ends, trace.told) == ("cut", {"gap", "speed"})


def test_parquet_says_what_is_not_known_in_lists():
    texts = pyarrow.list_(pyarrow.string())
    data = table(
        trace=["t", "t", "t"],
        step=[0, 0, 1],
        object=[None, "v", "v"],
        type=[None, "car", None],
        told=pyarrow.array([["gap", "speed"], None, None], texts),
        unknown=pyarrow.array([["speed"], ["gap"], []], texts),
        speed=pyarrow.array([None, None, None], pyarrow.float64()),
    )
    (trace,) = read(data, "parquet")
    assert trace.states == ({"speed": UNKNOWN, "gap": {"v": UNKNOWN}}, {})
    assert (trace.ends, trace.told) == ("complete", {"gap", "speed"})


HEAD = "trace,step,object,type,other,p\n"


@pytest.mark.parametrize(
    ("text", "line", "words", "way_out"),
    [
        ("", None, "there is no trace", ""),
        ("trace,step,p\n", None, "there is no trace", ""),
        ("\n\n", None, "there is no trace", ""),
        ('"trace', 1, "cannot be read as CSV", ""),
        (
            "trace,stop,p\nt,0,true\n",
            1,
            "there is no column `step`",
            "rename it to `step`",
        ),
        ("step,p\n0,true\n", 1, "there is no column `trace`", "traces have the columns"),
        ("track,time\na,0\n", 1, "there is no column `trace`", '(`form="tracks"`)'),
        ("time;speed\n", 1, "names are separated by semicolons", "separate the cells by commas"),
        ("trace;step\n", 1, "names are separated by semicolons", "separate the cells by commas"),
        ("step\ttrace\n", 1, "names are separated by tabs", "separate the cells by commas"),
        ("trace,step,\n", 1, "a column has no name", "pandas writes such a cell"),
        ("t1,0,1.0,,\n", 1, "a column has no name", "traces have the columns"),
        ("trace,step,p,p\n", 1, "there are two columns `p`", ""),
        (HEAD + "t,0,,,true\n", 2, "this row has 5 cells; there are 6 columns", ""),
        (HEAD + ",0,,,,true\n", 2, "does not name its trace", ""),
        (HEAD + "t,1,,,,true\n", 2, "the step is `1`; it must be 0 here", "are consecutive"),
        (HEAD + "t,-1,,,,true\nt,0,,,,true\n", 2, "the step is `-1`; it must be 0 here", ""),
        (HEAD + "t,0,,,,true\nt,2,,,,true\n", 3, "the step is `2`; it must be 0 or 1 here", ""),
        (HEAD + "t,0,,,,true\nt,1,,,,\nt,0,,,,\n", 4, "the step is `0`; it must be 1 or 2", ""),
        (HEAD + "t,0.0,,,,true\n", 2, "the step is `0.0`", "written without a point: 0, 1, 2"),
        (HEAD + "t,2026-01-01,,,,true\n", 2, "the step is `2026-01-01`", "a whole number"),
        (
            "trace,step,object,type,steps\nt,0,,,1.0\nt,0,v,car,1.0\n",
            3,
            "gives `steps` twice",
            "if `steps` means `step_s`, rename it",
        ),
        (HEAD + "t,,,,,true\n", 2, "the step is empty", ""),
        (HEAD + "t,0,v,,,true\n", 2, "object `v` does not give its `type`", ""),
        (HEAD + "t,0,v,car,,\nt,1,v,bus,,\n", 3, "`v` is of type `bus`; before it is of `car`", ""),
        (HEAD + "t,0,,car,,true\n", 2, "a `type`, but no `object`", ""),
        (HEAD + "t,0,,,w,true\n", 2, "a `other`, but no `object`", ""),
        (HEAD + "t,0,,,,true\nt,0,,,,false\n", 3, "step 0 gives `p` twice", ""),
        (HEAD + "t,0,v,car,,true\nt,0,v,car,,true\n", 3, "step 0 gives `p` twice for `v`", ""),
        (HEAD + "t,0,v,car,,true\nt,0,v,car,v,true\n", 3, "gives `p` twice for `v, v`", ""),
        ("trace,step,step_s\nt,0,x\n", 2, "`step_s` is `x`", ""),
        ("trace,step,step_s\nt,0,1\nt,1,2\n", 3, "`step_s` is `2`; in the rows before it is 1", ""),
        ("trace,step,step_s\nt,0,?\n", 2, "`step_s` is `?`", ""),
        ("trace,step,step_s\nt,0,nan\nt,1,nan\n", 2, "`step_s` is `nan`; it must be a number", ""),
        ("trace,step,p.from\n", 1, "a column `p.from`, but no `p.to`", "needs both bounds"),
        ("trace,step,p.from,p.to\nt,0,1,\n", 2, "`p.to` is empty", "needs both bounds"),
        ("trace,step,p.from,p.to\nt,0,?,1\n", 2, "`p.from` is `?`", "needs both bounds"),
        ("trace,step,p.from,p.to\nt,0,nan,1\n", 2, "`p.from` is `nan`", "needs both bounds"),
        ("trace,step,p.from,p.to\nt,0,2,1\n", 2, "the lower one first", ""),
        ("trace,step,p.from,p.to\nt,0,2,1e999\n", 2, "finite bounds", ""),
        ("trace,step,p,p.from,p.to\nt,0,?,1,2\n", 2, "step 0 gives `p` twice", ""),
        ("trace,step,ends\nt,0,cat\n", 2, "it must be `complete` or `cut`", ""),
        ("trace,step,ends\nt,0,cut\nt,1,complete\n", 3, "before it is `cut`", ""),
        ("trace,step,told\nt,0,a b\nt,1,a\n", 3, "other names in the rows before", ""),
        (HEAD + 't,0,,,,"true', 2, "it ends within quotes", "are they missing"),
        (HEAD + 't,0,,,,"true"x\n', 2, "closing quotes are followed", "are they missing"),
        (HEAD + f"t,0,,,,{'x' * 200_000}\n", 2, "more than 131,072 characters", ""),
        (HEAD + "t,0,,,,true\n" * 100 + "t\0,0,,,,true\n", 102, "a null character", ""),
        (HEAD + "t,0,,", 2, "this row has 4 cells", "has the file been cut short?"),
        (HEAD + "t,0,,,,a, b\n", 2, "this row has 7 cells", "in quotes"),
        ('{"states": [{}]}\n', None, "not CSV but JSON", "let its name end in `.jsonl`"),
    ],
)
def test_what_is_refused(text, line, words, way_out):
    found = problem(text)
    assert words in found.message
    assert found.place.line == line
    assert way_out in found.help


def test_a_trace_that_is_cut_off_is_not_taken_for_whole():
    a, error = read_text(HEAD + 'a,0,,,,true\nb,0,,,,true\nb,1,,,,"tr\nue')
    assert a.id == "a"
    assert error.diagnostics[0].place.line == 4


def test_bytes_that_are_no_text():
    """However many rows are before it, which have been decoded along with it."""
    found = problem(b"trace,step,p\nt,0,\n\nt,1,\n\xc3\xbc\xff,0,true\n")
    assert found.message == "the byte 0xff is not UTF-8"
    assert (found.place.line, found.place.column) == (5, 2)
    assert found.place.excerpt.startswith("\u00fc\ufffd,0")


def test_a_stream_may_be_closed_before_all_has_been_read():
    stream = io.BytesIO(b"trace,step\nt,0\nu,0\n")
    rows = csv_table._rows(stream, 1, "t")
    next(rows)
    stream.close()
    rows.close()  # does not raise


def test_a_bad_trace_does_not_hide_the_good_ones():
    text = HEAD + "a,0,,,,true\nb,1,,,,\nb,2,,,,\nc,0,,,,\nd,0\n"
    a, b, c, d = read_text(text)
    assert (a.id, c.id) == ("a", "c")
    assert [one.diagnostics[0].place.line for one in (b, d)] == [3, 6]


def test_the_end_of_a_name_says_the_format():
    ends = {"a.csv": "csv", "a.CSV": "csv", "a.parquet": "parquet", "a.pq": "parquet"}
    for name, form in {**ends, "a.jsonl": "jsonl", "a": "jsonl", "csv": "jsonl"}.items():
        assert format_of(name) == form


names = st.text("abc é,\"'\n;", min_size=1, max_size=4)
numbers = st.floats(allow_nan=False, allow_infinity=False)
intervals = st.lists(numbers, min_size=2, max_size=2).map(lambda ends: Interval(*sorted(ends)))
partial_numbers = numbers | intervals
words = st.sampled_from(["R_cw", "a b", "x,y"])
plain = st.sampled_from([st.booleans(), partial_numbers, words])
kinds = plain.map(lambda values: values | st.just(UNKNOWN))


@st.composite
def traces(draw):
    """Traces that a table can hold: one kind for each name, values of objects that are there."""
    of_nobody = {name: draw(kinds) for name in ("surface", "speed")}
    of_one = {name: draw(kinds) for name in ("position", "gap")}
    of_two = {"near": draw(kinds)}
    found = []
    for number in range(draw(st.integers(1, 3))):
        n_states = draw(st.integers(1, 4))
        objects = draw(st.dictionaries(names, st.sampled_from(["car", "bus"]), max_size=3))
        present = {}
        for name in objects:
            first = draw(st.integers(0, n_states - 1))
            last = draw(st.integers(first, n_states - 1))
            if (first, last) != (0, n_states - 1):
                present[name] = (first, last)
        states = []
        for step in range(n_states):
            there = [
                name
                for name in objects
                if present.get(name, (0, step))[0] <= step <= present.get(name, (0, step))[1]
            ]
            about = st.sampled_from(there) if there else st.nothing()
            state = draw(st.fixed_dictionaries({}, optional=of_nobody))
            for name, values in of_one.items():
                state[name] = draw(st.dictionaries(about, values))
            pairs = st.dictionaries(about, of_two["near"], min_size=1)
            state["near"] = draw(st.dictionaries(about, pairs))
            states.append({name: value for name, value in state.items() if value != {}})
        step_s = draw(st.floats(1e-3, 1e3))
        ends = draw(st.sampled_from(["complete", "cut"]))
        told = draw(st.none() | st.frozensets(st.sampled_from(["speed", "gap"])))
        written = Trace(f"t{number}", step_s, objects, tuple(states), present, ends=ends, told=told)
        found.append(written)
    return found


@pytest.mark.parametrize("form", ["csv", "parquet", "jsonl"])
@given(traces())
def test_written_traces_read_back(form, written):
    stream = io.BytesIO()
    found = kinds_in(state for trace in written for state in trace.states)
    partial = any(map(is_partial, written))
    write_traces(written, stream, "t", form, found, partial=partial)
    assert read(stream.getvalue(), form) == written


def test_a_name_that_is_a_column_cannot_be_written():
    with pytest.raises(ValueError, match="step"):
        columns_for({"step": float})


def table(**columns):
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), stream)
    return stream.getvalue()


def test_parquet_knows_types_of_its_own():
    data = table(
        trace=pyarrow.array([1, 1, 2]),
        step=pyarrow.array([0, 1, 0], pyarrow.uint8()),
        surface=pyarrow.array(["R_cw", None, "R_pc"]).dictionary_encode(),
        speed=pyarrow.array([3, 2**60, 0]),
        note=pyarrow.nulls(3),
    )
    assert read(data, "parquet") == [
        Trace("1", 1.0, {}, ({"surface": "R_cw", "speed": 3}, {"speed": 2**60})),
        Trace("2", 1.0, {}, ({"surface": "R_pc", "speed": 0},)),
    ]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "cannot be read as Parquet: it is empty"),
        (b"PAR1", "it has been cut short"),
        (b"PAR1 and no more", "it has been cut short"),
        (b"PAR1 and no contentsPAR1", "it is damaged"),
        (b"trace,step\n", "it does not begin with `PAR1`"),
        (gzip.compress(b"", mtime=0), "not Parquet but data compressed with gzip"),
        (table(trace=["t"], step=pyarrow.array([0.5])), "the step is `0.5`; it must be 0 here"),
        (table(trace=["t"], p=[True]), "there is no column `step`"),
        (table(trace=["t"], step=[0], step_s=[float("nan")]), "`step_s` is `nan`; it must be"),
        (table(trace=["t"], step=[0], p=[[True]]), "the column `p` is of type list"),
        (
            table(trace=["t"], step=[0], p=pyarrow.array([0.1], pyarrow.float32())),
            "the column `p` is of type float",
        ),
        (
            table(
                trace=pyarrow.array([], pyarrow.string()), step=pyarrow.array([], pyarrow.int8())
            ),
            "there is no trace",
        ),
    ],
)
def test_parquet_that_is_refused(data, words):
    assert words in problem(data, "parquet").message


@pytest.mark.parametrize("as_codes", [False, True])
def test_parquet_with_a_text_that_is_not_utf8(as_codes):
    names = pyarrow.array(["t0", "t1", "tQQ", "t3"])
    data = table(trace=names.dictionary_encode() if as_codes else names, step=[0, 0, 0, 0])
    # Who knows whether the second trace would have gone on there?
    first, bad = read(data.replace(b"tQQ", b"t\xff\xfe"), "parquet")
    assert first.id == "t0"
    (found,) = bad.diagnostics
    assert found.message == "the column `trace` has a text here that is not UTF-8"
    assert found.place.line == 3
    data = table(trace=["t"], step=[0], speQQ=[1]).replace(b"eQQ", b"e\xff\xfe")
    named = problem(data, "parquet")
    assert named.message == "a column has a name that is not UTF-8"


def test_a_parquet_file_that_is_cut_off():
    whole = table(trace=["t"] * 3, step=[0, 1, 2])
    for size in range(4, len(whole)):
        assert "it has been cut short" in problem(whole[:size], "parquet").message


def test_parquet_takes_a_package(monkeypatch):
    real = builtins.__import__

    def without(name, *rest, **more):
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(RulecError) as caught:
        read(b"", "parquet")
    (found,) = caught.value.diagnostics
    assert found.code == "R0706"
    assert "[parquet]'`" in found.help


def test_degrees_are_no_places(tmp_path):
    """Tracks in degrees look like traces, for neither has the columns of the other."""
    file = tmp_path / "gps.csv"
    file.write_text("id,t,lat,lon\na,0,48.1,11.5\n")
    with file.open("rb") as stream:
        ((error,),) = csv_table.read_csv(stream, file.name)
    (found,) = error.diagnostics
    assert found.help.startswith("tracks are not read in degrees: project them to metres")
