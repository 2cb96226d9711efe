"""Whatever the bytes are: a rulebook, or one RulecError whose diagnostics have places, in time."""

import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from steps import grows_in_proportion

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
        *("never ", " then ", "once ", " since ", " S ", "O "),
        *("not ", "weak ", " U ", "->", "is one of", "default", "as of 2020-01-01", "p", "b_v"),
        *("title", "law", "type", "signal", "quantity x in ", "\ud800", "\u202e", "\ufeff", "é"),
    ]
)


def diagnostics_of(text):
    try:
        parse_rulebook(text, "fuzz.rules")
    except RulecError as error:
        return error.diagnostics
    return None


def judge(text):
    """Read it; what is wrong has places and can be shown."""
    found = diagnostics_of(text)
    if found is None:
        return
    assert found
    assert all(one.place is not None and one.place.file for one in found)
    shown = render_diagnostics(found)
    assert not any(unicodedata.category(one) in ("Cc", "Cs") and one != "\n" for one in shown)
    assert not set(shown) & set("\u202e\u2028\ufeff")


@given(st.binary(max_size=300))
def test_random_bytes(data):
    try:
        source = decode("fuzz.rules", data)
    except RulecError as error:
        found = error.diagnostics
    else:
        _, found = parse(source)
    assert found, "no random bytes are a rulebook"
    assert all(one.place is not None for one in found)


@given(st.lists(FRAGMENTS, max_size=40).map("".join))
def test_random_fragments(text):
    judge(text)


@given(st.text(max_size=200))
def test_random_text(text):
    assert diagnostics_of(text), "no random text is a rulebook"
    judge(text)


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


@pytest.mark.parametrize("text", TEXTS, ids=lambda text: text.split("\n")[1])
def test_all_of_it_takes_steps_in_proportion(text):
    assert grows_in_proportion(lambda size: judge(text * size), 6)
