"""Whatever the bytes are: a rulebook, or one RulecError whose diagnostics have places; in time."""

import time
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.report.diagnostics import render_diagnostics
from rulec.rulebook.loader import parse_rulebook
from rulec.syntax import decode, parse

PROGRAMS = Path(__file__).parent.parent / "programs"
TEXTS = [path.read_text(encoding="utf-8") for path in sorted(PROGRAMS.glob("*/*.rules"))]
FRAGMENTS = st.sampled_from(
    [
        *("rulebook x", "vocabulary x {", "hard rule r (v: vehicle) {", "require ", "use paper\n"),
        *("accept {", "reject ", '"', "}", "{", "(", ")", ";", ",", "\n", "#", "\\", "'", "\0"),
        *("not ", "weak ", " U ", "->", "is one of", "default", "as of 2020-01-01", "p", "b_v"),
        *("title", "law", "type", "signal", "quantity x in ", "\ud800", "\u202e", "\ufeff", "é"),
    ]
)


def judge(text, name="fuzz.rules"):
    """Read it; every error has a place and can be shown."""
    try:
        parse_rulebook(text, name)
    except RulecError as error:
        assert error.diagnostics
        for one in error.diagnostics:
            assert one.place is not None
            assert one.place.file
        assert all(char.isprintable() or char == "\n" for char in _shown(error))


def _shown(error):
    return render_diagnostics(error.diagnostics).replace("\u200d", "").replace("\u00ad", "")


@given(st.binary(max_size=300))
def test_random_bytes(data):
    try:
        source = decode("fuzz.rules", data)
    except RulecError as error:
        assert error.diagnostics[0].place is not None
        return
    parse(source)


@given(st.lists(FRAGMENTS, max_size=40).map("".join))
def test_random_fragments(text):
    judge(text)


@given(st.text(max_size=200))
def test_random_text(text):
    parse_error = None
    try:
        parse_rulebook(text)
    except RulecError as error:
        parse_error = error
    assert parse_error is not None, "no random text is a rulebook"
    assert render_diagnostics(parse_error.diagnostics)


@given(st.data())
def test_mutated_rulebooks(data):
    text = data.draw(st.sampled_from(TEXTS))
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = min(len(text), start + data.draw(st.integers(0, 12)))
        text = text[:start] + data.draw(FRAGMENTS | st.just("")) + text[end:]
    judge(text)


@given(st.sampled_from(TEXTS), st.data())
def test_truncated_rulebooks(text, data):
    judge(text[: data.draw(st.integers(0, len(text)))])


def test_all_of_it_takes_no_longer_than_the_file_is_long():
    started = time.monotonic()
    for text in TEXTS:
        judge(text * 20)
    assert time.monotonic() - started < 60
