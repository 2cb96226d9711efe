"""The tokens of ``grammar/rulec.lark`` as editors need them: as fixed texts, or as patterns."""

from __future__ import annotations

import re
from functools import cache
from typing import Any, Final

from lark import Tree
from lark.load_grammar import load_grammar

from rulec.resources import grammar_file

WORD_START: Final = r"[\p{L}\p{Nl}\p{No}_]"
WORD: Final = WORD_START + r"[\p{L}\p{N}_]*"
"""A name, in Unicode classes that every dialect of regular expressions supports."""

_BOUNDARY = re.compile(r"\\b|\(\?!(?:[^()\\]|\\.)*\)$")
_RESERVED = re.compile(r"^\(\?!\(\?:.*?\)\\b\)")
_POWER: Final = r"(\^-?[0-9]+)?"


@cache
def language_rules() -> tuple[tuple[str, Tree[Any], bool], ...]:
    """The grammar's rules: name, tree in EBNF, whether it is replaced by its only child."""
    return tuple((name, tree, options.expand1) for name, _, tree, options in _grammar().rule_defs)


@cache
def spellings() -> dict[str, tuple[str, ...]]:
    """Terminal -> its texts, with single blanks between the words of each.

    A terminal with infinitely many texts, such as a name, has no entry.
    """
    return {
        name: tuple(_unescaped(text) for text in re.split(r"(?<!\\)\|", _optional(pattern)))
        for name, pattern in _patterns().items()
        if not _is_class(pattern)
    }


@cache
def patterns() -> dict[str, str]:
    """Terminal with infinitely many texts -> its regular expression, including reserved words."""
    return {
        name: pattern.replace(r"[^\W\d]\w*", WORD)
        .replace(r"\w", r"[\p{L}\p{N}_]")
        .replace("?:", "")
        for name, pattern in _patterns().items()
        if _is_class(pattern)
    }


def compound_units() -> str:
    """A pattern for the units that are not words: ``%``, ``km/h``, ``m/s^2``."""
    return rf"[%°]|{WORD}\^-?[0-9]+|{WORD}{_POWER}(/{WORD}{_POWER})+"


def _patterns() -> dict[str, str]:
    """Terminal -> its regular expression without look-ahead."""
    found = {}
    for name, (tree, _) in _grammar().term_defs:
        if not name.startswith("__"):
            literal = next(tree.find_data("literal")).children[0]
            text = str(literal)[1:-1]
            text = re.escape(text) if literal.type == "STRING" else text
            found[name] = _BOUNDARY.sub("", _RESERVED.sub("", text))
    return found


def _is_class(pattern: str) -> bool:
    return re.search(r"(?<!\\)\[", pattern) is not None


def _optional(pattern: str) -> str:
    """Expand the optional second sign: ``&&?`` becomes ``&&|&``."""
    return re.sub(r"((?:\\?[&|])(\\?[&|]))\?", lambda pair: f"{pair[1]}|{pair[2]}", pattern)


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", r"\1", text.replace(r"\s+", " "))


@cache
def _grammar() -> Any:
    text = grammar_file("rulec.lark").read_text(encoding="utf-8")
    made: Any = load_grammar  # the function has no type hints
    return made(text, "rulec.lark", [], global_keep_all_tokens=True)[0]
