"""Traces as JSON Lines: what is read, what is refused, and in which words."""

import io
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.trace import Trace, json_lines
from rulec.trace.json_lines import read_traces, write_traces
from rulec.trace.lines import lines_as_they_come

GOOD = {
    "id": "t1",
    "step_s": 0.5,
    "objects": {"v1": "vehicle"},
    "states": [{"position": {"v1": "b"}, "surface": "R_cw", "CONGESTED": False, "speed": 3}],
}


def read(data):
    return list(read_traces(io.BytesIO(data), "t.jsonl"))


def line(**changes):
    return json.dumps({**GOOD, **changes}).encode() + b"\n"


def problem(data):
    (error,) = read(data)
    assert isinstance(error, RulecError)
    (diagnostic,) = error.diagnostics
    assert diagnostic.place.file == "t.jsonl"
    return diagnostic


def test_a_trace_is_read():
    (trace,) = read(line())
    assert trace == Trace("t1", 0.5, GOOD["objects"], tuple(GOOD["states"]))
    assert (trace.place.file, trace.place.line) == ("t.jsonl", 1)


def test_what_may_be_left_out():
    (trace,) = read(b'{"states": [{}]}')
    assert trace == Trace("line 1", 1.0, {}, ({},))


def test_blank_lines_a_bom_and_a_missing_last_line_end():
    traces = read(b"\xef\xbb\xbf" + line() + b"\n  \r\n" + line(id=7).rstrip())
    assert [(trace.id, trace.place.line) for trace in traces] == [("t1", 1), ("7", 4)]


@pytest.mark.parametrize(
    ("data", "way_out"),
    [
        (b'{"step": 1, "states": [{}]}', "did you mean `step_s`?"),
        (b'{"state": [{}]}', "did you mean `states`?"),
        (b'{"states": [{"v": NaN}]}', "JSON has no `NaN` and no infinity"),
        (b'{"states": [{"v": -Infinity}]}', "JSON has no `NaN` and no infinity"),
        (b"{'states': [{}]}", "in JSON texts stand in double quotes"),
        (b'{"states": [{"p": True}]}', "in JSON texts stand in double quotes"),
        (b'{"zebra": 1, "states": [{}]}', "a trace is a line such as"),
        (b"{", "a trace is a line such as"),
    ],
)
def test_the_way_out(data, way_out):
    assert problem(data).help.startswith(way_out)


def test_a_bad_line_does_not_hide_the_good_ones():
    found = read(line(id="a") + b"{oops\n" + line(id="b"))
    assert [item.id for item in found if isinstance(item, Trace)] == ["a", "b"]
    assert found[1].diagnostics[0].place.line == 2


@pytest.mark.parametrize(
    ("data", "code", "words"),
    [
        (b"", "R0501", "there is no trace in this file"),
        (b"\n\n", "R0501", "there is no trace in this file"),
        (b"{", "R0501", "truncated"),
        (b"\xff\xfe{}", "R0501", "not a trace"),
        (b"\x00", "R0501", "not a trace"),
        (b"[1]", "R0501", "expected an object, got a list"),
        (b"[" * 100_000, "R0501", "not a trace"),
        (b"{}", "R0501", "missing required field `states`"),
        (line(states=[{}, 3]), "R0501", "(in `states[1]`)"),
        (line(states=[{"p": None}]), "R0501", "got null"),
        (line(states=[{"p": [1]}]), "R0501", "got a list"),
        (b'{"states": [{"speed": NaN}]}', "R0501", "malformed"),
        (b'{"states": [{"speed": 1e999}]}', "R0501", "out of range"),
        (line(step_s="1"), "R0501", "expected a number, got a string (in `step_s`)"),
        (line(sates=[]), "R0501", "unknown field `sates`"),
        (line(objects=["v1"]), "R0501", "(in `objects`)"),
        (line(present={"v1": 3}), "R0501", "(in `present"),
    ],
)
def test_what_is_refused(data, code, words):
    diagnostic = problem(data)
    assert diagnostic.code == code
    assert words in diagnostic.message


def test_a_line_without_end_is_refused_without_keeping_it(monkeypatch):
    monkeypatch.setattr(json_lines, "LONGEST_LINE_BYTES", 1000)
    found = read(b"x" * 5000 + b"\n" + line(id="after"))
    assert "longer than" in found[0].diagnostics[0].message
    assert [item.id for item in found[1:]] == ["after"]


@given(st.binary(max_size=200))
def test_random_bytes_are_an_error_with_a_place(data):
    for found in read(data):
        assert isinstance(found, Trace) or found.diagnostics[0].place.file == "t.jsonl"


values = st.booleans() | st.text() | st.floats(allow_nan=False, allow_infinity=False)
traces = st.builds(
    lambda states, step, objects, stretch: Trace(
        "t",
        step,
        objects,
        tuple(states),
        {name: stretch(len(states)) for name in objects},
    ),
    st.lists(
        st.dictionaries(st.text(), values | st.dictionaries(st.text(), values)),
        min_size=1,
        max_size=4,
    ),
    st.floats(min_value=1e-3, max_value=1e3),
    st.dictionaries(st.text(), st.text(), max_size=3),
    st.sampled_from([lambda n: (0, n - 1), lambda n: (n - 1, n - 1)]),
)


@given(st.lists(traces, min_size=1, max_size=3))
def test_written_traces_read_back(written):
    stream = io.BytesIO()
    assert write_traces(written, stream) == len(written)
    assert read(stream.getvalue()) == written


class Pipe(io.BytesIO):
    """A stream of which each read gives as much as has been written at once."""

    def __init__(self, *writes):
        super().__init__()
        self.writes = list(writes)

    def read1(self, size=-1):
        return self.writes.pop(0) if self.writes else b""


def test_a_pipe_is_read_as_lines_arrive():
    one, two, three = (line(id=name) for name in "abc")
    pipe = Pipe(one, two[:20], two[20:] + three[:5], three[5:-1])
    chunks = json_lines.read_chunks(pipe, "pipe")
    assert [trace.id for trace in next(chunks)] == ["a"]
    assert len(pipe.writes) == 3
    assert [trace.id for trace in next(chunks)] == ["b"]
    assert [trace.id for trace in next(chunks)] == ["c"]
    assert list(chunks) == []


def test_states_that_are_written_alike_are_one():
    first, second = read(line() + line(id="t2"))
    assert first.states[0] is second.states[0]


def test_states_that_never_come_again_are_not_remembered(monkeypatch):
    monkeypatch.setattr(json_lines._StateReader, "_MOST", 10)
    lines = [line(id=str(n), states=[{"speed": n}, {"speed": n + 0.5}]) for n in range(20)]
    traces = read(b"".join(lines))
    assert [[state["speed"] for state in trace.states] for trace in traces] == [
        [n, n + 0.5] for n in range(20)
    ]


@given(st.lists(st.binary(max_size=30), max_size=8), st.randoms(use_true_random=False))
def test_lines_are_the_same_however_they_arrive(parts, chance):
    data = b"\n".join(parts)
    writes = []
    while data:
        size = chance.randint(1, 20)
        writes.append(data[:size])
        data = data[size:]
    found = [line for lines in lines_as_they_come(Pipe(*writes), 1000) for line in lines]
    expected = b"\n".join(parts).split(b"\n")
    # After the last line feed nothing begins.
    assert found == (expected if expected[-1] else expected[:-1])
