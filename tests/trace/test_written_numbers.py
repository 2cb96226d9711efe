"""Numbers count as they are written, in every format and for every engine."""

import io
import json
import pickle
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.api.named_monitor import Monitor
from rulec.automata.compiler import compile_rulebook
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.moments.name_tables import tables_of
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.trace.formats import csv_table, json_lines
from rulec.trace.formats.trace_files import read_chunks, write_traces
from rulec.vocabulary.written_numbers import WrittenNumber, number_written

LIMIT = Fraction("48.28032")
SOURCE = """
rulebook numbers
quantity v in km/h
quantity w in km/h default 0
hard rule below { require always v < 30 mph }
hard rule above { require always v > 9007199254740992 km/h }
hard rule both { require always v + w > 9007199254740992 km/h }
"""


@pytest.fixture(scope="module")
def rules():
    return compile_rulebook(parse_rulebook(SOURCE, "n.rules"))


NUMBERS = st.builds(
    lambda digits, places, power: f"{digits[:places]}.{digits[places:] or 0}{power}",
    st.sampled_from(["4828032", "9007199254740992", "48280319999999997", "1"]).flatmap(
        lambda start: st.text("0123456789", min_size=1, max_size=25).map(start.__add__)
    ),
    st.integers(1, 16),
    st.sampled_from(["", "", "e1", "E-2", "e-310", "e+3"]),
)


def violated(answers):
    return [[one.rule for one in answer.violations] for answer in answers]


def judged(items, rules):
    return [answer for _, some in verify_items(items, rules) for answer in some]


def read(text, form):
    return [one for chunk in read_chunks(io.BytesIO(text.encode()), "t", form) for one in chunk]


@given(st.lists(NUMBERS, min_size=1, max_size=6))
@example(["9007199254740993", "48.280320000000001", "1e-400", "48.2803200000000000", "0.1"])
def test_a_number_counts_as_it_is_written(rules, numbers):
    expected = []
    for text in numbers:
        number = Fraction(text)
        expected.append(
            [
                name
                for name, is_kept in (
                    ("below", number < LIMIT),
                    ("above", number > 2**53),
                    ("both", number > 2**53),
                )
                if not is_kept
            ]
        )
    lines = "".join(f'{{"states": [{{"v": {text}}}]}}\n' for text in numbers)
    table = "trace,step,v\n" + "".join(f"{n},0,{text}\n" for n, text in enumerate(numbers))
    by_format = {"jsonl": lines, "csv": table}
    for form, text in by_format.items():
        traces = read(text, form)
        assert violated([verify(trace, rules) for trace in traces]) == expected
        assert violated(judged(traces, rules)) == expected
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv_table, "LARGE_BYTES", 0)
        chunks = list(read_chunks(io.BytesIO(table.encode()), "t", "csv"))
        found = [answer for chunk in chunks for answer in judged(chunk, rules)]
        assert violated(found) == expected
    for text, names in zip(numbers, expected, strict=True):
        stream = io.BytesIO(f'{{"state": {{"v": {text}}}}}\n'.encode())
        (live,) = json_lines.read_live(stream, "s")
        monitor = Monitor(rules)
        monitor.step(live.state, live.objects)
        assert [one.rule for one in monitor.violations] == names


@given(NUMBERS, NUMBERS)
def test_written_numbers_are_told_apart_and_in_order(first, second):
    left, right = number_written(first), number_written(second)
    assert (left == right) == (Fraction(first) == Fraction(second))
    if isinstance(left, WrittenNumber) or isinstance(right, WrittenNumber):
        assert (left < right) == (Fraction(first) < Fraction(second))
        assert (left >= right) == (Fraction(first) >= Fraction(second))
    assert pickle.loads(pickle.dumps(left)) == left
    if isinstance(left, WrittenNumber):
        low, high = left.neighbours
        assert Fraction(repr(low)) < Fraction(first) < Fraction(repr(high))
        assert -left == number_written(f"-{first}")


@pytest.mark.parametrize("form", ["jsonl", "csv"])
def test_they_are_written_as_they_were_read(form):
    text = "48.280320000000001"
    trace = Trace("t", 1.0, {}, ({"v": number_written(text)},))
    stream = io.BytesIO()
    write_traces([trace], stream, "t", form, {"v": float})
    assert text in stream.getvalue().decode()
    assert read(stream.getvalue().decode(), form) == [trace]


@pytest.mark.parametrize("text", ["1e-99999999", "0." + "1" * 2000])
def test_what_is_too_long_is_refused(text):
    traces = [
        *read(f'{{"states": [{{"v": {text}}}]}}\n', "jsonl"),
        *read(f"trace,step,v\nt,0,{text}\n", "csv"),
    ]
    for refused in traces:
        assert "has too many digits, or is too near to 0" in str(refused)


def test_moments_know_between_what_it_lies(rules):
    state = json.loads('{"v": 48.280320000000001}', parse_float=number_written)
    number = tables_of(Trace("t", 1.0, {}, (state,)), rules.vocabulary).world("v")
    low, high = number.low[0, 0].item(), number.high[0, 0].item()
    assert Fraction(repr(low)) < Fraction("48.280320000000001") < Fraction(repr(high))


def test_an_example_says_what_it_says():
    examples = "v < 30 mph accept { v = 48.280319999999999 km/h } reject { v = 48.28032 km/h }"
    book = parse_rulebook(SOURCE.replace("v < 30 mph", examples), "n.rules")
    outcomes = run_rulebook_examples(book, compile_rulebook(book)).outcomes
    assert [one.passed for one in outcomes] == [True, True]


def test_numbers_differ_that_have_one_nearest_float():
    one, other = number_written("9007199254740993"), number_written("9007199254740992.5")
    assert float(one) == float(other)
    assert one != other
    assert one != float(one)
    assert not one != number_written("9007199254740993.0")  # noqa: SIM202 - its own operator


def test_a_constant_with_two_values_of_one_float_is_refused():
    words = "rulebook c\nquantity limit in m default 0\nconstant limit\n"
    words += "hard rule r { require limit < 9 m }"
    rules = compile_rulebook(parse_rulebook(words, "c.rules"))
    values = (number_written("9007199254740993"), number_written("9007199254740992.5"))
    trace = Trace("t", 1.0, {}, tuple({"limit": value} for value in values))
    with pytest.raises(RulecError) as caught:
        verify(trace, rules)
    assert [problem.code for problem in caught.value.diagnostics] == ["R0503"]
