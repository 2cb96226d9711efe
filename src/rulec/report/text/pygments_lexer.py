"""Rulebooks for Pygments, which colours them in documentation and in terminals."""

from __future__ import annotations

import re
from typing import Any, ClassVar

from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Literal, Name, Number, Operator, Punctuation, String
from pygments.token import Text as Blank

from rulec.report.text import highlighting_words as words

_NAMED: Any = bygroups(  # type: ignore[no-untyped-call]
    Keyword.Declaration, Blank.Whitespace, Name.Function
)
_NUMBER_WITH_UNIT: Any = bygroups(  # type: ignore[no-untyped-call]
    Number, Blank.Whitespace, Keyword.Type
)


class RulecLexer(RegexLexer):
    """Lexer of the rulec language, ``rulec`` or ``rules``, for files ``*.rules``."""

    name = "rulec"
    aliases: ClassVar[list[str]] = ["rulec", "rules"]
    filenames: ClassVar[list[str]] = ["*.rules"]
    flags = re.MULTILINE

    tokens: ClassVar[dict[str, list[Any]]] = {
        "root": [
            (r"\s+", Blank.Whitespace),
            (words.COMMENT, Comment.Single),
            (words.STRING, String.Double),
            (r'"[^"\n]*$', String.Double),  # a string without an end is still meant as one
            (words.RULE_NAME, _NAMED),
            (words.DEFINED_NAME, _NAMED),
            (words.DATE, Literal.Date),
            (words.NUMBER_WITH_UNIT, _NUMBER_WITH_UNIT),
            (words.SETTINGS, Keyword.Constant),
            (words.SCOPES, Keyword.Pseudo),
            (words.IN_FORCE, Keyword.Pseudo),
            (words.any_of(words.STRUCTURE_WORDS), Keyword.Declaration),
            (words.any_of(words.CLAUSES), Keyword),
            (words.any_of(words.CONSTANTS), Keyword.Constant),
            (words.any_of(words.OPERATORS), Operator.Word),
            (words.any_of(words.JOINING_WORDS), Keyword.Pseudo),
            (words.OPERATOR_SIGNS, Operator),
            (words.NUMBER, Number),
            (r"[^\W\d]\w*", Name),
            (r"[{}()\[\],:;%°.]", Punctuation),
        ]
    }
