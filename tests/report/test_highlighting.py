"""Highlighters know the words that the parser knows."""

import json
import re
from pathlib import Path

import pytest
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.token import Comment, Error, Keyword, Literal, Name, Operator, String

from rulec.report.pygments_lexer import RulecLexer
from rulec.report.textmate import textmate_grammar
from rulec.syntax.keywords import ITEM_WORDS, OPERATOR_LETTERS, OPERATOR_WORDS, RESERVED, SYMBOLS

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


def test_pygments_finds_the_lexer():
    assert type(get_lexer_by_name("rulec")) is RulecLexer
    assert type(get_lexer_for_filename("de.rules")) is RulecLexer


def test_the_textmate_grammar_is_up_to_date():
    file = ROOT / "grammar" / "rulec.tmLanguage.json"
    assert file.read_text(encoding="utf-8") == textmate_grammar(), (
        "python -m rulec.report.textmate grammar/rulec.tmLanguage.json"
    )


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
