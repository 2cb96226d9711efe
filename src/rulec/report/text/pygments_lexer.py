"""Rulebooks for Pygments, which colours them in documentation and in terminals."""

from __future__ import annotations

import re
from typing import Any, ClassVar, Final

from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Literal, Name, Number, Operator, Punctuation, String
from pygments.token import Text as Blank

from rulec.syntax import keywords

_NAMED: Any = bygroups(  # type: ignore[no-untyped-call]
    Keyword.Declaration, Blank.Whitespace, Name.Function
)
_NUMBER_WITH_UNIT: Any = bygroups(  # type: ignore[no-untyped-call]
    Number, Blank.Whitespace, Keyword.Type
)


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


class RulecLexer(RegexLexer):
    """Lexer of the rulec language, ``rulec`` or ``rules``, for files ``*.rules``."""

    name = "rulec"
    aliases: ClassVar[list[str]] = ["rulec", "rules"]
    filenames: ClassVar[list[str]] = ["*.rules"]
    flags = re.MULTILINE

    tokens: ClassVar[dict[str, list[Any]]] = {
        "root": [
            (r"\s+", Blank.Whitespace),
            (COMMENT, Comment.Single),
            (STRING, String.Double),
            (r'"[^"\n]*$', String.Double),  # a string without an end is still meant as one
            (RULE_NAME, _NAMED),
            (DEFINED_NAME, _NAMED),
            (DATE, Literal.Date),
            (NUMBER_WITH_UNIT, _NUMBER_WITH_UNIT),
            (SETTINGS, Keyword.Constant),
            (SCOPES, Keyword.Pseudo),
            (IN_FORCE, Keyword.Pseudo),
            (any_of(STRUCTURE_WORDS), Keyword.Declaration),
            (any_of(CLAUSES), Keyword),
            (any_of(CONSTANTS), Keyword.Constant),
            (any_of(OPERATORS), Operator.Word),
            (any_of(JOINING_WORDS), Keyword.Pseudo),
            (OPERATOR_SIGNS, Operator),
            (NUMBER, Number),
            (r"[^\W\d]\w*", Name),
            (r"[{}()\[\],:;%°.]", Punctuation),
        ]
    }
