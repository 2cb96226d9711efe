"""Bytes that are not the text of a rulebook, and characters that a text may not hold."""

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.syntax import decode, parse


def only(data):
    with pytest.raises(RulecError) as caught:
        decode("file.rules", data)
    (one,) = caught.value.diagnostics
    return one


def test_a_byte_order_mark_is_dropped():
    assert decode("file.rules", "\ufeffrulebook ü".encode()).text == "rulebook ü"


def test_another_encoding_is_named_with_its_place():
    one = only('rulebook a\ntitle "M\xfcnchen"\n'.encode("latin-1"))
    assert one.code == "R0101"
    assert "0xfc is not UTF-8" in one.message
    assert (one.place.line, one.place.column) == (2, 9)
    assert one.help == "save the file as UTF-8"


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_utf_16_is_not_text(encoding):
    one = only("rulebook a".encode(encoding))
    assert one.code == "R0101"
    assert ("UTF-16" in one.message) == (encoding == "utf-16")


def test_a_null_character_has_a_place():
    one = only(b"rulebook a\nsignal p\0q\n")
    assert (one.code, one.place.line, one.place.column) == ("R0101", 2, 9)


@pytest.mark.parametrize("text", ["", "  \n\t\n", "# only a comment"])
def test_an_empty_file_is_one_error(text):
    tree, (one,) = parse(Source("file.rules", text))
    assert one.code == "R0103"
    assert one.expected == "expected `rulebook NAME`"
    assert tree.name is None


@pytest.mark.parametrize(
    "character", ["\x1b", "\x07", "\x85", "\u2028", "\u202e", "\u2066", "\ud800"]
)
def test_a_text_holds_no_control_characters(character):
    text = f'rulebook a\nsignal p\nhard rule r {{\n  says "one{character}two"\n  require p\n}}\n'
    _, (one,) = parse(Source("file.rules", text))
    assert (one.code, one.place.line, one.place.column) == ("R0107", 4, 12)


@pytest.mark.parametrize("character", ["\t", "\u200c", "\u00a0", "é", "車", "\U0001f600"])
def test_a_text_holds_what_people_write(character):
    text = f'rulebook a\nsignal p\nhard rule r {{\n  says "one{character}two"\n  require p\n}}\n'
    tree, mistakes = parse(Source("file.rules", text))
    assert mistakes == ()
    assert tree.items[1].says.value == f"one{character}two"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_of_any_kind(end):
    text = end.join(["rulebook a", "signal p", "hard rule r {", "  require p", "}", ""])
    assert parse(Source("file.rules", text))[1] == ()


def test_a_text_ends_on_its_line():
    _, (one,) = parse(
        Source("file.rules", 'rulebook a\ntitle "one\nsignal p\nhard rule r {require p}')
    )
    assert (one.code, one.place.line, one.place.column) == ("R0105", 2, 7)
