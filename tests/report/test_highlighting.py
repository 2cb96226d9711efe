"""Highlighters know the words that the parser knows."""

import json
import re
from pathlib import Path

import pytest
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.token import (
    Comment,
    Error,
    Keyword,
    Literal,
    Name,
    Number,
    Operator,
    Punctuation,
    String,
)

from rulec.report.text.pygments_lexer import RulecLexer
from rulec.syntax.keywords import ITEM_WORDS, OPERATOR_LETTERS, OPERATOR_WORDS, RESERVED, SYMBOLS
from tools.textmate import textmate_grammar

ROOT = Path(__file__).resolve().parents[2]
RULEBOOKS = [*(ROOT / "rulebooks").rglob("*.rules"), *(ROOT / "tests").rglob("good/*.rules")]
TEXTMATE = json.loads(textmate_grammar())


@pytest.mark.parametrize("file", RULEBOOKS, ids=lambda file: file.stem)
def test_every_rulebook_is_coloured_whole(file):
    text = file.read_text(encoding="utf-8")
    tokens = list(RulecLexer().get_tokens(text))
    assert [value for kind, value in tokens if kind in Error] == []
    assert "".join(value for _, value in tokens).strip() == text.strip()


def kinds(text):
    return [(kind, value) for kind, value in RulecLexer().get_tokens(text) if value.strip()]


@pytest.mark.parametrize("word", sorted(RESERVED))
def test_reserved_words_are_no_names(word):
    ((kind, _),) = kinds(word)
    assert kind in (Operator if word in OPERATOR_WORDS | OPERATOR_LETTERS else Keyword)
    # A name that begins with one is a name.
    assert kinds(f"{word}_x") == [(Name, f"{word}_x")]


@pytest.mark.parametrize("sign", [sign for sign in SYMBOLS.values() if not sign[0].isalpha()])
def test_signs_are_operators(sign):
    assert kinds(sign) == [(Operator, sign)]


def test_a_rule():
    found = kinds('hard rule R1 (v: vehicle) { # why\n  cite "a \\" b" } # 1968-11-08\n')
    assert (Name.Function, "R1") in found
    assert (Comment.Single, "# why") in found
    assert (String.Double, '"a \\" b"') in found
    assert kinds('law "x" as of 1968-11-08')[-1] == (Literal.Date, "1968-11-08")


NEW = """\
priority safety > legal = courtesy
traffic left
param pace : speed = 7.5 km/h in force from 2020-04-28
define near(v: vehicle) = gap(v) >= 2 s * speed or left
override hard rule R1 (v: vehicle) in legal weight 2 {
  require always[1 s .. 4 s] gap(v) != -1.5e3 m/s^2
  unless some x: vehicle (near(x)) at some point
  accept { speed = 50% and p }
}
"""


def test_the_whole_language_is_coloured():
    found = kinds(NEW)
    assert Error not in [kind for kind, _ in found]
    for name in ("near", "R1"):
        assert (Name.Function, name) in found
    for number, unit in [("7.5", "km/h"), ("2", "s"), ("1.5e3", "m/s^2"), ("50", "%")]:
        at = found.index((Number, number))
        assert (Keyword.Type, unit) in found[at : at + 6]
    for sign in (">=", "*", "[", "..", "!=", "-", "=", ">"):
        kind = Punctuation if sign == "[" else Operator
        assert (kind, sign) in found
    for word in ("priority", "traffic", "param", "override", "hard", "define", "rule"):
        assert (Keyword.Declaration, word) in found
    assert (Keyword.Constant, "left") in found
    assert (Name, "left") in found
    assert (Keyword.Pseudo, "at some point") in found
    assert (Keyword.Pseudo, "in force from") in found
    assert (Literal.Date, "2020-04-28") in found


def test_a_number_before_a_word_has_no_unit():
    assert kinds("2 and") == [(Number, "2"), (Operator.Word, "and")]
    assert kinds("p > 2\nhard") == [
        (Name, "p"),
        (Operator, ">"),
        (Number, "2"),
        (Keyword.Declaration, "hard"),
    ]
    assert kinds("next[1 step]")[2:4] == [(Number, "1"), (Keyword.Type, "step")]


def test_textmate_knows_numbers_and_their_units():
    (one,) = (rule for rule in TEXTMATE["patterns"] if "unit" in str(rule))
    for text, number, unit in [("5 km/h", "5", "km/h"), ("1.5m", "1.5", "m"), ("3 %", "3", "%")]:
        found = re.search(one["match"], f"p < {text} and q")
        assert (found[1], found[3]) == (number, unit)
    assert re.search(one["match"], "p < 5 and q") is None
    assert re.search(one["match"], "p < 5\nq") is None


def test_pygments_finds_the_lexer():
    assert type(get_lexer_by_name("rulec")) is RulecLexer
    assert type(get_lexer_for_filename("de.rules")) is RulecLexer


@pytest.mark.parametrize("word", sorted(RESERVED))
def test_textmate_colours_every_reserved_word_once(word):
    hits = [one for one in TEXTMATE["patterns"] if re.fullmatch(one["match"], word)]
    assert len(hits) == 1
    operator = word in OPERATOR_WORDS | OPERATOR_LETTERS
    assert ("operator" in hits[0]["name"]) == operator
    assert (hits[0]["name"] == "storage.type.rulec") == (word in ITEM_WORDS)


def test_textmate_leaves_names_alone():
    for name in ("untilx", "rules", "b_v", "Güte", "_is"):
        assert not any(re.fullmatch(one["match"], name) for one in TEXTMATE["patterns"])
