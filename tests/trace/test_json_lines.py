"""Traces as JSON Lines: what is read, what is refused, and in which words."""

import gzip
import io
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.trace import Trace
from rulec.trace.formats import json_line_problems, json_lines, stream_lines
from rulec.trace.formats.json_lines import read_chunks, write_traces
from rulec.trace.formats.stream_lines import lines_as_they_come
from rulec.vocabulary.partial_values import UNKNOWN, Interval

GOOD = {
    "id": "t1",
    "step_s": 0.5,
    "objects": {"v1": "vehicle"},
    "states": [{"position": {"v1": "b"}, "surface": "R_cw", "CONGESTED": False, "speed": 3}],
}


def read(data):
    return [item for chunk in read_chunks(io.BytesIO(data), "t.jsonl") for item in chunk]


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
    assert trace == Trace("t1", 0.5, GOOD["objects"], tuple(GOOD["states"]), ends="cut")
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
        (b'{"states": [{"v": NaN}]}', "JSON has neither `NaN` nor infinity: write `null`"),
        (b'{"states": [{"v": -Infinity}]}', "JSON has neither `NaN` nor infinity"),
        (b"{'states': [{}]}", "JSON has texts in double quotes"),
        (b'{"states": [{"p": True}]}', "JSON has texts in double quotes"),
        (b'{"states": [{}], "ends": "never"}', '`"ends": "complete"` or `"ends": "cut"`'),
        (b'{"version": 1, "rule": "r", "outcome": "open"}', "it is a finding of `rulec verify`"),
        (b'{"version": 1, "trace": "t", "satisfied": true}', "it is a verdict of `rulec verify`"),
        (b'{"version": 1, "states": [{}]}', "the fields are `states`, `id`"),
        (b'{"zebra": 1, "states": [{}]}', "the fields are `states`, `id`, `step_s`, `objects`"),
        (b'{"states": [{}]} {"states": [{}]}', "write each trace on a line of its own"),
        (b'{"step_s": "0.5", "states": [{}]}', "numbers are written without quotes"),
        (b"{", "write or copy the file again"),
        (b"[1]", "a trace is a line such as"),
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
        (b"", "R0501", "there is no trace in this file: it is empty"),
        (b"\n\n", "R0501", "there is no trace in this file: it is empty"),
        (line(id="\xe4").replace(b"\\u00e4", b"\xe4"), "R0501", "the byte 0xe4 is not UTF-8"),
        (b"[1]", "R0501", "expected an object, got a list"),
        (b"[" * 100_000, "R0501", "not a trace"),
        (b"{}", "R0501", "missing required field `states`"),
        (line(states=[{}, 3]), "R0501", "(in `states[1]`)"),
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


@pytest.mark.parametrize(
    ("data", "noun"),
    [
        (gzip.compress(line(), mtime=0), "data compressed with gzip"),
        (b"PK\x03\x04" + line(), "a ZIP archive"),
        (b"PAR1" + line(), "Parquet"),
        (b"BZh91AY&SY" + line(), "data compressed with bzip2"),
        (b"\xfd7zXZ\0" + line(), "data compressed with xz"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "a Git LFS pointer"),
        (b"ARROW1" + line(), "Arrow (Feather)"),
        (b"\xd0\xcf\x11\xe0" + line(), "an Excel or Word file"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "a picture (PNG)"),
        (b"%PDF-1.4\n%\xac\xdc\n1 0 obj\n", "a PDF document"),
        (line().decode().encode("utf-16"), "text in UTF-16"),
        (line().decode().encode("utf-16-le"), "text in UTF-16"),
        (line().decode().encode("utf-16-be"), "text in UTF-16"),
        (b"\0\0\0\0" + line(), "binary data"),
        (b"\x00", "binary data"),
        (b"\x7fELF\x02\x01\n", "binary data"),
    ],
)
def test_a_file_that_is_something_else_is_one_mistake(data, noun):
    found = problem(data + b"\n" + data)
    assert found.message == f"these are not traces but {noun}"
    assert found.help
    assert found.place.line is None


def test_csv_and_a_list_are_one_mistake():
    assert "`.csv`" in problem(b"trace,step,p\nt,0,true\nt,1,true\n").help
    pretty = json.dumps([GOOD, GOOD], indent=1).encode()
    in_lines = b"[\n" + line().rstrip() + b",\n" + line() + b"]\n"
    for data in (pretty, in_lines):
        assert problem(data).message == "this is a list in JSON, not one trace per line"


@pytest.mark.parametrize(("separator", "way_out"), [("\n", ", lines=True"), (",", "")])
def test_rows_of_tracks_are_one_mistake(separator, way_out):
    row = '{"track": 1, "t": 0, "x": 1, "y": 0}'
    rows = separator.join([row, row])
    found = problem((rows if way_out else f"[{rows}]").encode())
    assert "rows of tracks" in found.message
    assert f"{way_out}).to_csv('tracks.csv', index=False)" in found.help


@pytest.mark.parametrize(
    ("before", "where"),
    [
        ('{"id": "t7", "states": [{"p": true}, {"q": fal', "state 1 of trace `t7`"),
        ('{"id": 7, "states": [{"p": {"v": "b, ]}"}}, {"p": {"v', "state 1 of trace `7`"),
        ('{"id": "t", "states": [', "state 0 of trace `t`"),
        ('{"states": [{"p": true}], "id": "t", "objects": {"v', "trace `t`"),
        ('{"id": "t', "a trace"),
        ("{", "a trace"),
    ],
)
def test_a_file_that_is_cut_short_says_where(before, where):
    good, error = read(line() + before.encode())
    (found,) = error.diagnostics
    assert good.id == "t1"
    assert found.message == f"the file ends in the middle of {where}: it has been cut short"
    assert (found.place.line, found.place.column) == (2, len(before))


@given(st.integers(1, len(line()) - 2))
def test_wherever_it_is_cut(size):
    found = problem(line()[:size])
    assert found.message.startswith("the file ends in the middle of ")


def test_a_line_that_is_cut_short_between_others():
    a, error, b = read(line(id="a") + line()[:50] + b"\n" + line(id="b"))
    assert (a.id, b.id) == ("a", "b")
    assert error.diagnostics[0].place.line == 2
    assert "the line ends in the middle of trace `t1`: it has been" in error.diagnostics[0].message


def test_a_trace_over_several_lines_is_one_mistake():
    pretty = json.dumps(GOOD, indent=2).encode() + b"\n"
    first, second, good = read(pretty + pretty + line())
    for error, number in ((first, 1), (second, 1 + pretty.count(b"\n"))):
        (found,) = error.diagnostics
        assert found.place.line == number
        assert found.message.endswith("goes on below: a trace is one line")
        assert "jq -c" in found.help
    assert good.id == "t1"


def test_the_place_of_what_is_malformed():
    found = problem('{"id": "ü", "states": [{"v": NaN}]}'.encode())
    assert found.message == "this is not a trace: JSON is malformed: invalid character"
    # The thirtieth character, which is the thirty-first byte.
    assert (found.place.line, found.place.column) == (1, 30)
    assert found.place.excerpt[29:32] == "NaN"


def test_a_field_is_called_as_it_is_written():
    assert "unknown field `object`" in problem(line(object={})).message


@pytest.mark.parametrize("half", [r"\ud800", r"\uDBFF", r"\udc00", r"\udc00\ud800"])
@pytest.mark.parametrize("behind", ["", "x", r"\n", "a much longer text"])
@pytest.mark.parametrize("before", ["", r"\ud83d\ude00 \\ud900"])
def test_half_a_character_is_not_the_end_of_a_line(before, half, behind):
    found = problem(f'{{"states": [], "id": "{before}{half}{behind}"}}'.encode())
    assert "has been cut short" not in found.message
    assert found.message == f"this is not a trace: `{half[:6]}` is half of a surrogate pair"


@pytest.mark.parametrize("size", range(17, 28))
def test_a_pair_of_surrogates_may_be_cut_short(size):
    whole = r'{"id": "t", "id": "\ud83d\ude00"'
    assert "it has been cut short" in problem(whole[:size].encode()).message


def test_a_line_without_end_is_refused_without_keeping_it(monkeypatch):
    monkeypatch.setattr(json_line_problems, "LONGEST_LINE_BYTES", 1000)
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


@given(
    st.lists(st.binary(max_size=30), max_size=8),
    st.randoms(use_true_random=False),
)
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


class Endless:
    """As ``/dev/zero``."""

    blocks = 0

    def read1(self, size):
        self.blocks += 1
        return bytes(1000)


def test_of_a_line_without_end_there_is_a_part(monkeypatch):
    monkeypatch.setattr(stream_lines, "_MOST_SKIPPED", 1_000_000)
    stream = Endless()
    ((found,),) = lines_as_they_come(stream, 5000)
    assert (len(found), stream.blocks) == (6000, 1001)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (
            '{"from": 2, "to": 1}',
            "in state 1 `speed`: an interval has finite bounds, the lower one",
        ),
        ('{"from": 1}', "is an interval without a number for `from` or `to`"),
        ('{"to": 1}', "is an interval without a number for `from` or `to`"),
        ('{"from": null, "to": 1}', "is an interval without a number for `from` or `to`"),
        ('{"from": true, "to": 1}', "is an interval without a number for `from` or `to`"),
        ('{"from": {"from": 1, "to": 2}, "to": 1}', "is an interval without a number"),
        ('{"from": NaN, "to": 1}', "invalid character"),
        ('{"from": 1, "to": 1e999}', "out of range"),
    ],
)
def test_what_is_no_interval(value, words):
    (error,) = read(f'{{"states": [{{}}, {{"speed": {value}}}]}}\n'.encode())
    assert words in str(error)
    assert "R0501" in str(error)


def test_intervals():
    huge = 10**400
    text = f'{{"states": [{{"speed": {{"\\u0066rom": 1, "to": {huge}}}}}, {{"speed": null}}]}}\n'
    (trace,) = read(text.encode())
    assert trace.states == ({"speed": Interval(1, huge)}, {"speed": UNKNOWN})


def test_objects_called_from_and_to():
    about = {"from": 1, "to": 2}
    both = line(objects={"from": "car", "to": "car"}, states=[{"gap": about}])
    one = line(objects={"from": "car"}, states=[{"gap": {"from": about}, "speed": about}])
    first, second = read(both + one)
    assert first.states == ({"gap": about},)
    assert second.states == ({"gap": {"from": Interval(1, 2)}, "speed": Interval(1, 2)},)


@pytest.mark.parametrize(
    ("text", "way_out"),
    [
        (line(dt=0.1), "the fields are `states`, `id`, `step_s`, `objects`"),
        (line(objects=["v1"]), 'objects have types: write "objects": {"v1": "car"}'),
        (line(objects={"v1": 3}), 'objects have types: write "objects": {"v1": "car"}'),
    ],
)
def test_a_way_out_shows_what_is_meant(text, way_out):
    assert way_out in problem(text).help


@pytest.mark.parametrize("blank", ["\n", " \n", "\t\r\n"])
def test_blank_lines_are_passed_over(blank):
    """Others keep their numbers."""
    trace = '{"states": [{"p": true}, {"p": false}]}\n'
    text = blank * 20_000 + trace + blank * 20_000 + trace + "{\n" + blank * 3
    stream = io.BytesIO(text.encode())
    found = [one for chunk in read_chunks(stream, "t.jsonl") for one in chunk]
    assert [one.place.line for one in found[:2]] == [20_001, 40_002]
    assert found[2].diagnostics[0].place.line == 40_003
    assert len(found) == 3
