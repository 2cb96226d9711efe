"""The keywords of the language by kind, for syntax highlighting in every editor."""

from __future__ import annotations

from typing import Final

from rulec.syntax import keywords

CONSTANTS: Final = ("false", "true")
STRUCTURE_WORDS: Final = tuple(sorted(keywords.ITEM_WORDS))
CLAUSES: Final = tuple(sorted(keywords.CLAUSE_WORDS))
OPERATORS: Final = tuple(sorted(keywords.OPERATOR_WORDS | keywords.OPERATOR_LETTERS))
JOINING_WORDS: Final = tuple(
    sorted(keywords.RESERVED - {*STRUCTURE_WORDS, *CLAUSES, *OPERATORS, *CONSTANTS})
)
"""The small words of headers and declarations: ``is one of``, ``default``, ``in``, …."""

OPERATOR_SIGNS: Final = r"<->|->|<>|\[\]|&&?|\|\|?|!=|<=|>=|\.\.|[!^<>=+*/-]"
COMMENT: Final = r"#.*$"
STRING: Final = r'"(?:[^"\\\n]|\\.)*"'
DATE: Final = r"\b\d{4}-\d{2}-\d{2}\b"
NUMBER: Final = r"(?<!\w)\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
_UNIT: Final = r"[^\W\d]\w*(?:\^-?\d+)?(?:/[^\W\d]\w*(?:\^-?\d+)?)*"
NUMBER_WITH_UNIT: Final = (
    rf"({NUMBER})([^\S\n]*)([%°]|(?!(?:{'|'.join(sorted(keywords.RESERVED - {'step'}))})\b){_UNIT})"
)
"""A number and the unit after it on the same line: groups 1 and 3."""
RULE_NAME: Final = r"\b(rule)(\s+)([^\W\d]\w*)"
DEFINED_NAME: Final = r"\b(define|redefine)(\s+)([^\W\d]\w*)"
SCOPES: Final = r"\bat\s+(?:start|some\s+point|end)\b"
IN_FORCE: Final = r"\bin\s+force\b(?:\s+from\b)?"
SETTINGS: Final = (
    r"\b(?:(?<=traffic )(?:left|right)|(?<=semantics )(?:stutter|finite)|(?<== )(?:on|off)"
    r"|(?<=certainty )(?:verified|secondary|unverified))\b"
)
"""Words that are keywords only in their place, preceded by one blank as the formatter writes it."""


def any_of(words: tuple[str, ...]) -> str:
    """A regular expression for whole words."""
    return rf"\b(?:{'|'.join(words)})\b"
