"""Tables judged column by column: every answer is the one that its trace gets, read row by row."""

import csv
import io
import re
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random
from unittest import mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.bundle.bundle_file import to_json
from rulec.monitoring.batch.batch_verify import rulebook_for, verify_items
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.trace.formats import csv_table, table_reader
from rulec.trace.formats import table_blocks as trace_blocks
from rulec.trace.formats.arrow import arrow_blocks
from rulec.trace.formats.table_blocks import Block
from rulec.trace.formats.trace_files import is_partial, kinds_in, read_chunks, write_traces
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.rulebooks import compile_here
from support.generators.random_records import chunks, rulebooks, told

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from rulec.trace.formats.arrow import arrow_csv as plain_csv  # noqa: E402
from rulec.trace.formats.arrow import parquet as parquet_table  # noqa: E402


def answers(data, form, rules):
    found = []
    for items in read_chunks(io.BytesIO(data), "t", form):
        found += [answer for _, some in verify_items(items, rules) for answer in some]
    return [told(one) for one in found]


def by_columns(data, form, rules, block_bytes=1 << 22):
    """The answers, without minding how few rows there are, in blocks of some bytes."""
    with (
        mock.patch.object(csv_table, "LARGE_BYTES", 1),
        mock.patch.object(plain_csv, "_BLOCK_BYTES", block_bytes),
        mock.patch.object(parquet_table, "_ROWS_AT_ONCE", 1 + block_bytes // 40),
    ):
        return answers(data, form, rules)


def row_by_row(data, form, rules):
    read = [one for items in read_chunks(io.BytesIO(data), "t", form) for one in items]
    return [told(verify_or_reason(one, rules)) for one in read]


def as_csv(rows):
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def as_parquet(rows):
    names, *rest = rows
    columns = zip(*rest, strict=True) if rest else [()] * len(names)
    arrays = [as_array(name, column) for name, column in zip(names, columns, strict=True)]
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(arrays, names), stream)
    return stream.getvalue()


def as_array(name, column):
    """An array of the first type that holds a column: integers for steps, then as in CSV."""
    cells = [csv_table._value(one) if one else None for one in column]
    try:
        if name == "step":
            return pyarrow.array([None if one is None else int(one) for one in cells])
        return pyarrow.array(cells)
    except (pyarrow.ArrowException, ValueError, OverflowError):
        return pyarrow.array([one or None for one in column])


FORMS = {"csv": as_csv, "parquet": as_parquet}


def rows_of(traces):
    kinds = kinds_in(state for trace in traces for state in trace.states)
    stream = io.BytesIO()
    write_traces(traces, stream, "t", "csv", kinds)
    return list(csv.reader(io.StringIO(stream.getvalue().decode())))


words = st.sampled_from(["", "true", "false", "near", "gone", "car", "thing", "a", "b", "x", " "])
words |= st.sampled_from(["cut", "complete"])
numerals = st.sampled_from(["0", "1", "2", "0.3", "nan", "1e999", "-.5", "9007199254740993"])
cells = words | numerals | st.sampled_from(['qu"ote', "li\nne", "é"])


@st.composite
def tables(draw):
    """The rows of traces, in which a few cells may be anything, and rows anywhere."""
    ends = st.sampled_from(["complete", "cut"])
    rows = rows_of([replace(one, ends=draw(ends)) for one in draw(chunks()) if one.states])
    if draw(st.booleans()):
        place = rows[0].index("ends")
        rows = [[*row[:place], *row[place + 1 :]] for row in rows]
    for change in draw(st.lists(st.sampled_from(["cell", "drop", "twice", "swap"]), max_size=2)):
        if len(rows) < 3:
            break
        row = draw(st.integers(1, len(rows) - 1))
        if change == "cell":
            column = draw(st.integers(0, len(rows[row]) - 1))
            rows[row] = [*rows[row][:column], draw(cells), *rows[row][column + 1 :]]
        elif change == "drop":
            del rows[row]
        elif change == "twice":
            rows.insert(row, rows[row])
        else:
            other = draw(st.integers(1, len(rows) - 1))
            rows[row], rows[other] = rows[other], rows[row]
    return rows


@pytest.mark.parametrize("form", FORMS)
@given(rulebooks(), tables(), st.integers(1, 400))
def test_answers_are_those_of_the_rows(form, rulebook, rows, block_bytes):
    rules = compile_here(rulebook)
    data = FORMS[form](rows)
    assert by_columns(data, form, rules, block_bytes) == row_by_row(data, form, rules)


LEAVES = """rulebook leaves
type car
signal p(v: car)
signal q(v: car) default false
hard rule kept (v: car) { require eventually !p(v) }"""


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("lacking", [None, ("1", "b"), ("2", "a")])
def test_the_last_value_before_an_object_leaves_is_needed(form, lacking):
    rules = compile_here(parse_rulebook(LEAVES))
    objects, both = {"a": "car", "b": "car"}, {"a": True, "b": True}
    states = ({"p": both, "q": both}, {"p": both, "q": both}, {"p": {"a": True}, "q": {"a": True}})
    header, *rows = rows_of([Trace("t", 1.0, objects, states, {"b": (0, 1)})])
    step, item, p = header.index("step"), header.index("object"), header.index("p")
    for row in rows:
        if (row[step], row[item]) == lacking:
            row[p] = ""
    data = FORMS[form]([header, *rows])
    answered = by_columns(data, form, rules)
    assert answered == row_by_row(data, form, rules)
    assert ("R0504" in str(answered)) is (lacking is not None)


TRAFFIC = """rulebook traffic
type car
type bus is car
place(v: car) is one of left, right
signal yields_to(v: car, w: car) default false
quantity speed(v: car) in km/h
signal rain default false
hard rule mutual (v: car, w: bus) {
  require always (yields_to(v, w) implies next left(w))
}
soft rule calm (v: car) { require never (speed(v) > 50 km/h and rain) }
"""


@cache
def traffic():
    return compile_here(parse_rulebook(TRAFFIC, "traffic.rules"))


def drive(chance, number):
    """A trace whose objects nobody else knows; the bus comes later, unless it is left out."""
    bus = f"{number}.bus"
    names = [f"{number}.{n}" for n in range(2)]
    n_states = chance.randint(2, 5)

    def state(step):
        there = [*names, bus] if step else names
        return {
            "place": {name: chance.choice(["left", "right"]) for name in there},
            "speed": {name: round(chance.uniform(0, 51), 3) for name in there},
            "yields_to": {v: {w: chance.random() < 0.1 for w in there} for v in there},
            "rain": chance.random() < 0.5,
        }

    objects = dict.fromkeys(names, "car") | {bus: "bus"}
    states = tuple(state(step) for step in range(n_states))
    return Trace(f"t{number}", 0.5, objects, states, {bus: (1, n_states - 1)})


def written(traces, form):
    stream = io.BytesIO()
    kinds = kinds_in(state for trace in traces for state in trace.states)
    partial = any(map(is_partial, traces))
    write_traces(traces, stream, "t", form, kinds, partial=partial)
    return stream.getvalue()


@cache
def drives():
    chance = Random(5)
    return [drive(chance, number) for number in range(500)]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("block_bytes", [20_000, 1 << 22])
def test_plain_tables_make_no_traces(form, block_bytes, monkeypatch):
    data = written(drives(), form)
    alone = [verify_or_reason(trace, traffic()) for trace in drives()]
    bound = {item for one in alone for lost in one.violations for item in lost.binding.values()}
    assert len(bound) > 100
    assert any(one.violations == () for one in alone)
    for module in (table_reader, arrow_blocks):
        monkeypatch.setattr(module, "traces_in", lambda *_: pytest.fail("a row was read"))
    assert by_columns(data, form, traffic(), block_bytes) == alone


@pytest.mark.parametrize("form", FORMS)
def test_only_traces_of_which_something_is_not_known_are_read(form, monkeypatch):
    traces = list(drives()[:100])
    for place, change in ((5, {"rain": UNKNOWN}), (20, {"yields_to": UNKNOWN})):
        states = ({**traces[place].states[0], **change}, *traces[place].states[1:])
        traces[place] = replace(traces[place], states=states)
    traces[70] = replace(traces[70], told=frozenset(["rain", "speed"]))
    traces[71] = replace(traces[71], ends="cut")
    alone = [verify_or_reason(trace, traffic()) for trace in traces]
    data, read = written(traces, form), []
    for module in (table_reader, arrow_blocks):
        monkeypatch.setattr(module, "traces_in", noted(module.traces_in, read))
    assert by_columns(data, form, traffic()) == alone
    # What columns say of it, as `?`, they are read from.
    assert read == ["t70"]


def noted(traces_in, read):
    def noting(*arguments):
        for trace in traces_in(*arguments):
            read.append(trace.id)
            yield trace

    return noting


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data.replace(b"\n", b"\r\n"),
        lambda data: b"\xef\xbb\xbf" + data,
        lambda data: data.removesuffix(b"\n"),
        lambda data: re.sub(rb"(?<=[,\n])([^,\n]+)(?=[,\n])", rb'"\1"', data),
    ],
    ids=["line ends", "byte order mark", "no last line end", "quotes"],
)
def test_csv_that_is_plain_too(change, monkeypatch):
    data = change(written(drives()[:60], "csv"))
    for module in (table_reader, arrow_blocks):
        monkeypatch.setattr(module, "traces_in", lambda *_: pytest.fail("a row was read"))
    expected = [verify_or_reason(trace, traffic()) for trace in drives()[:60]]
    assert by_columns(data, "csv", traffic(), 3_000) == expected


@pytest.mark.parametrize(("form", "first"), [("csv", 1), ("parquet", 0)])
def test_what_is_wrong_with_a_row_is_said_of_its_trace(form, first):
    rows = rows_of(drives()[:100])
    place = next(n for n, row in enumerate(rows) if row[:2] == ["t60", "1"])
    rows[place][1] = "7"
    found = by_columns(FORMS[form](rows), form, traffic(), 5_000)
    assert found[:60] == [verify_or_reason(trace, traffic()) for trace in drives()[:60]]
    assert found[61:] == [verify_or_reason(trace, traffic()) for trace in drives()[61:100]]
    trace, (problem,) = found[60]
    assert trace is None
    assert problem.message == "the step is `7`; it must be 0 or 1 here"
    assert problem.place.line == place + first


@pytest.mark.parametrize(
    ("steps", "kind"),
    [([0, -1], "int8"), ([0, 2**63], "uint64"), ([2**64 - 1, 0], "uint64"), ([0, 1], "float64")],
)
def test_steps_that_are_none(steps, kind):
    stream = io.BytesIO()
    columns = {"trace": ["t", "t"], "step": pyarrow.array(steps, kind)}
    parquet.write_table(pyarrow.table(columns), stream)
    ((trace, (problem,)),) = by_columns(stream.getvalue(), "parquet", traffic())
    assert trace is None
    assert problem.message.startswith("the step is `")


@pytest.mark.parametrize(
    "odd", ['"', '"a\nb",', '"x,"', 'a"b', "\r", "\n\n", "\x00", "\ufeff", "x" * 140_000]
)
def test_csv_is_read_by_rows_from_where_it_is_not_plain(odd):
    lines = written(drives()[:60], "csv").decode().splitlines(keepends=True)
    for place in (2, len(lines) // 2, len(lines) - 1):
        text = "".join([*lines[:place], odd, *lines[place:]])
        found = by_columns(text.encode(), "csv", traffic(), 3_000)
        assert found == row_by_row(text.encode(), "csv", traffic())


@pytest.mark.parametrize("numbers", ["{}.5", ".{}", "+{}", "1e{}", "{}"])
def test_many_numbers_are_those_that_are_written(numbers):
    """More than are read one by one, in spellings of which Arrow reads some."""
    texts = [numbers.format(n) for n in range(1, 3000)]
    column = arrow_blocks._texts_read(pyarrow.array([*texts, None, "12"]), csv_table._value)
    assert column.given.tolist() == [True] * 2999 + [False, True]
    if isinstance(column, trace_blocks.Numbers):
        found = column.numbers[:-2].tolist()
    else:
        found = [column.values[code] for code in column.codes[:-2].tolist()]
    assert found == [float(text) for text in texts]


@given(st.lists(st.sampled_from([None, "", "a", "aa", "ab", "ba", "aba", "b", "1", "1.0", "11"])))
def test_a_column_has_the_values_that_are_written(texts):
    column = arrow_blocks._texts_read(pyarrow.array(texts, pyarrow.string()), csv_table._value)
    assert column.given.tolist() == [bool(text) for text in texts]
    rows = np.flatnonzero(column.given)
    expected = [csv_table._value(text) for text in texts if text]
    assert trace_blocks.cells_of(column, rows) == expected


@pytest.mark.parametrize("odd", ["?", "TRUE", " true", "left", "1"])
def test_a_column_of_truth_values_in_which_late_there_is_something_else(odd, monkeypatch):
    rows = rows_of(drives()[:100])
    rain = rows[0].index("rain")
    place = next(n for n, row in enumerate(rows) if row[:2] == ["t90", "1"] and row[rain])
    rows[place][rain] = odd
    data, read = as_csv(rows), []
    expected = row_by_row(data, "csv", traffic())
    assert expected[:90] == [verify_or_reason(trace, traffic()) for trace in drives()[:90]]
    for module in (table_reader, arrow_blocks):
        monkeypatch.setattr(module, "traces_in", noted(module.traces_in, read))
    assert by_columns(data, "csv", traffic(), 6_000) == expected
    # Blocks that have only truth values there are read as others are.
    assert "t10" not in read
    assert "t99" not in read


def test_large_csv_is_read_without_what_takes_long_to_load(tmp_path):
    (tmp_path / "t.csv").write_bytes(written(drives(), "csv"))
    program = """
import sys
from rulec.trace.formats import csv_table
csv_table.LARGE_BYTES = 1
chunks = [*csv_table.read_csv(open("t.csv", "rb"), "t.csv")]
print([type(one).__name__ for one in chunks], *{"pyarrow.compute", "pandas"} & {*sys.modules})
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert done.stdout == "['Block', 'Block']\n"


def test_the_rulebook_of_a_trace_is_the_one_for_its_step():
    asked = []
    data = written(drives()[:40], "csv")
    with mock.patch.object(csv_table, "LARGE_BYTES", 1):
        items, last = read_chunks(io.BytesIO(data), "t", "csv")
    # What follows the last trace of a block might have been a row of it.
    assert (len(items), len(last)) == (39, 1)
    assert isinstance(items, Block)
    rulebook = mock.Mock(fitted_to=lambda step: asked.append(step) or traffic())
    assert rulebook_for(items, 3, rulebook) is traffic()
    assert asked == [Fraction(1, 2)]
    ((found, answered),) = verify_items(items, traffic())
    assert isinstance(found, Block)
    assert found.outline is not None
    assert list(found) == list(items)
    assert [found[place] for place in range(39)] == list(items)
    assert [*answered][3] == verify_or_reason(drives()[3], traffic())
    assert items[3] == drives()[3]


def test_large_csv_without_arrow(monkeypatch):
    monkeypatch.setattr(csv_table, "find_spec", lambda _: None)
    data = written(drives()[:40], "csv")
    expected = [verify_or_reason(trace, traffic()) for trace in drives()[:40]]
    assert by_columns(data, "csv", traffic()) == expected


PEAK = """
import sys
from pathlib import Path
import rulec
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.trace.formats import csv_table
from rulec.trace.formats.arrow import arrow_csv, parquet
from rulec.trace.formats.trace_files import read_chunks

csv_table.LARGE_BYTES, arrow_csv._BLOCK_BYTES, parquet._ROWS_AT_ONCE = 1, 1 << 18, 1 << 13
rulebook, file, form = sys.argv[1:]
rules = rulec.compile_rulebook(rulebook)
with open(file, "rb") as stream:
    print(sum(
        len([*answers])
        for one in read_chunks(stream, file, form)
        for _, answers in verify_items(one, rules)
    ))
(peak,) = (one for one in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in one)
print(int(peak.split()[1]) << 10)
"""


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="says what memory was used")
@pytest.mark.parametrize("form", FORMS)
def test_a_larger_file_takes_no_more_memory(form, tmp_path):
    (tmp_path / "traffic.json").write_text(to_json(traffic()))
    peaks = []
    for copies in (4, 60):
        file = tmp_path / f"{copies}.{form}"
        if form == "csv":
            head, _, body = written(drives(), form).partition(b"\n")
            file.write_bytes(b"\n".join([head, body * copies]))
        else:
            table = parquet.read_table(io.BytesIO(written(drives(), form)))
            whole = pyarrow.concat_tables([table] * copies)
            parquet.write_table(whole, file, row_group_size=1 << 13)
            assert whole.nbytes > copies * 500_000
        command = [sys.executable, "-c", PEAK, tmp_path / "traffic.json", file, form]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        n_judged, peak = map(int, done.stdout.split())
        assert n_judged == copies * len(drives())
        peaks.append(peak)
    # The larger file holds forty megabytes more, as Parquet seventy once it is read.
    assert peaks[1] - peaks[0] < 20_000_000
