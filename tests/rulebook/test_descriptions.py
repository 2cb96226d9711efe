"""What the comments beside a declaration say of it."""

import pytest

from rulec.rulebook.names.doc_comments import description
from rulec.syntax import decode, parse


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("# What a light is.\nsignal p", "What a light is."),
        ("  # It rains,\n  #   or snows.\n  signal p", "It rains, or snows."),
        ("# The weather.\nsignal p  # It rains.", "It rains."),
        ("signal p  # It rains.", "It rains."),
        ("signal p\n# About what follows.", ""),
        ("# About the whole file.\n\nsignal p", ""),
        ("signal p", ""),
        ("# one\nsignal q\nsignal p", ""),
        ("##\n# boxed\n##\nsignal p", "boxed"),
    ],
)
def test_what_is_said_of_the_last_signal(text, expected):
    file, _ = parse(decode("x", f"rulebook x\n{text}".encode()))
    assert description(file.items[-1].span) == expected
