"""Whatever the bytes are: a rulebook, or one RulecError whose diagnostics have places, in time."""

import re
import unicodedata
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError, Source
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.rulebook.loader import parse_rulebook
from rulec.syntax import decode, parse
from rulec.syntax.keywords import CONTEXTUAL, RESERVED, SYMBOLS
from rulec.syntax.scanner import scan
from support.builders.counted_steps import grows_in_proportion
from support.generators.language_constructs import CLAUSES, HEADER, ITEMS

PROGRAMS = Path(__file__).parent.parent / "programs"
SYNTAX = [
    "".join(f"{construct.right[0]}\n" for construct in group) for group in (HEADER, ITEMS, CLAUSES)
]
ONE_REQUIRE = re.sub(r"(?m)^require (?!always).*\n", "", SYNTAX[2])
BOOK = (
    f"rulebook fuzz\n{SYNTAX[0]}{SYNTAX[1]}hard rule a (v: vehicle) in b weight 2 {{\n"
    f"{ONE_REQUIRE}}}\noverride rule c {{ unless p }}\n"
)
# Units and the word `machine-readable` are one word each, of tokens without a gap.
_WORDS = BOOK.replace("km/h", "m").replace('not machine-readable because ""', "")
TOKENS = [one.text for one in scan(Source("fuzz.rules", _WORDS))]
BAD, GOOD = (
    [path.read_text(encoding="utf-8") for path in sorted(PROGRAMS.glob(f"{folder}/*.rules"))]
    for folder in ("bad", "good")
)
TEXTS = [*BAD, *GOOD]
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


def read(text):
    """Text to tree: the mistakes have places within the file, in order."""
    _, found = parse(Source("fuzz.rules", text))
    lines = text.split("\n")
    for one in found:
        place = one.place
        assert 1 <= place.line <= len(lines)
        assert 1 <= place.column <= len(lines[place.line - 1]) + 1
        assert one.message
        assert not NAMES_OF_TOKENS.search(one.expected)
    assert [one.place.start for one in found] == sorted(one.place.start for one in found)
    return found


NAMES_OF_TOKENS = re.compile(r"`([lr](sqb|par|brace)|at_\w+|on_topic|equals|greater|less|\$end)`")
MORE_TOKENS = st.sampled_from(
    [
        *sorted(RESERVED | CONTEXTUAL),
        *SYMBOLS.values(),
        *("[", "]", "[]", "..", "<=", ">=", "<", ">", "=", "!=", "==", "=<", "<=>", "+", "-", "*"),
        *("(", ")", "{", "}", ",", ";", ":", ":=", "?", "**", "%", "1.5", "3", "2020-04-28", '"a"'),
        *('"', "'", "\n", "name", "km/h", "…", "\ud800"),
    ]
)


def test_the_book_to_be_mutated_is_read():
    assert read(BOOK) == ()
    assert read(" ".join(TOKENS)) == ()


@given(st.data())
def test_tokens_left_out_doubled_swapped_and_put_in(data):
    tokens = list(TOKENS)
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.integers(0, len(tokens) - 1))
        match data.draw(st.sampled_from(["leave out", "double", "swap", "put in", "break"])):
            case "leave out":
                del tokens[at]
            case "double":
                tokens.insert(at, tokens[at])
            case "swap":
                other = data.draw(st.integers(0, len(tokens) - 1))
                tokens[at], tokens[other] = tokens[other], tokens[at]
            case "put in":
                tokens.insert(at, data.draw(MORE_TOKENS))
            case "break":
                tokens.insert(at, "\n")
    read(" ".join(tokens))


@given(st.lists(MORE_TOKENS, max_size=60))
def test_random_tokens(tokens):
    read(" ".join(tokens))
    read("rulebook a hard rule r { require " + " ".join(tokens))


@given(st.integers(0, len(BOOK)), st.integers(0, len(BOOK)))
def test_a_part_of_a_book(first, last):
    read(BOOK[first:last])
    read(f"rulebook a\n{BOOK[first:]}")


@given(st.sampled_from(TEXTS), st.data())
def test_truncated_rulebooks(text, data):
    judge(text[: data.draw(st.integers(0, len(text)))])


A_FEW = {*GOOD, *BAD[::5]}
"""Counting steps makes a program many times slower: what is right, and some of what is wrong."""


@pytest.mark.parametrize(
    "text",
    [pytest.param(text, marks=[] if text in A_FEW else pytest.mark.long) for text in TEXTS],
    ids=lambda text: text.split("\n")[1],
)
def test_all_of_it_takes_steps_in_proportion(text):
    # As much text, about, and never one copy alone, which lacks what repeated names lead to
    copies = 8 if len(text) < 1000 else 4
    assert grows_in_proportion(lambda size: judge(text * size), copies)
