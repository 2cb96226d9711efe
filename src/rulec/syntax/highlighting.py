"""What an editor colours how: the words of the language by kind, for every highlighter."""

from __future__ import annotations

from typing import Final

from rulec.syntax.keywords import (
    CLAUSE_WORDS,
    DECLARATION_WORDS,
    HEADER_WORDS,
    OPERATOR_LETTERS,
    OPERATOR_WORDS,
    RESERVED,
    RULE_WORDS,
)

CONSTANTS: Final = ("false", "true")
STRUCTURE_WORDS: Final = tuple(
    sorted({*HEADER_WORDS, *DECLARATION_WORDS, *RULE_WORDS, "rule"}),
)
CLAUSES: Final = tuple(sorted(CLAUSE_WORDS))
OPERATORS: Final = tuple(sorted(OPERATOR_WORDS | OPERATOR_LETTERS))
JOINING_WORDS: Final = tuple(
    sorted(RESERVED - {*STRUCTURE_WORDS, *CLAUSES, *OPERATORS, *CONSTANTS})
)
"""The small words of headers and declarations: ``is one of``, ``default``, ``in``, …."""

OPERATOR_SIGNS: Final = r"<->|->|<>|\[\]|&&?|\|\|?|[!^]"
COMMENT: Final = r"#.*$"
STRING: Final = r'"(?:[^"\\\n]|\\.)*"'
DATE: Final = r"\b\d{4}-\d{2}-\d{2}\b"
NUMBER: Final = r"(?<!\w)[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?\b"
RULE_NAME: Final = r"\b(rule)(\s+)([^\W\d]\w*)"


def any_of(words: tuple[str, ...]) -> str:
    """A regular expression for whole words."""
    return rf"\b(?:{'|'.join(words)})\b"
