"""The TextMate grammar in ``grammar/``, generated from the words that the parser knows."""

from __future__ import annotations

import json
from typing import Any

from rulec.report.text import pygments_lexer as words


def textmate_grammar() -> str:
    """Generate the grammar as JSON for editors."""
    return json.dumps(_grammar(), indent=2, ensure_ascii=False) + "\n"


def _grammar() -> dict[str, Any]:
    return {
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "name": "rulec",
        "scopeName": "source.rulec",
        "fileTypes": ["rules"],
        "patterns": [
            _pattern("comment.line.number-sign.rulec", words.COMMENT),
            _pattern("string.quoted.double.rulec", words.STRING),
            _named(words.RULE_NAME),
            _named(words.DEFINED_NAME),
            {
                "match": words.NUMBER_WITH_UNIT,
                "captures": {
                    "1": {"name": "constant.numeric.rulec"},
                    "3": {"name": "keyword.other.unit.rulec"},
                },
            },
            _pattern("constant.other.date.rulec", words.DATE),
            _pattern("constant.language.rulec", words.SETTINGS),
            _pattern("keyword.other.rulec", words.SCOPES),
            _pattern("keyword.other.rulec", words.IN_FORCE),
            _pattern("storage.type.rulec", words.any_of(words.STRUCTURE_WORDS)),
            _pattern("keyword.control.rulec", words.any_of(words.CLAUSES)),
            _pattern("constant.language.rulec", words.any_of(words.CONSTANTS)),
            _pattern("keyword.operator.word.rulec", words.any_of(words.OPERATORS)),
            _pattern("keyword.other.rulec", words.any_of(words.JOINING_WORDS)),
            _pattern("keyword.operator.rulec", words.OPERATOR_SIGNS),
            _pattern("constant.numeric.rulec", words.NUMBER),
        ],
    }


def _pattern(name: str, match: str) -> dict[str, str]:
    return {"name": name, "match": match}


def _named(match: str) -> dict[str, Any]:
    """The pattern for a word and the name that it declares."""
    return {
        "match": match,
        "captures": {
            "1": {"name": "storage.type.rulec"},
            "3": {"name": "entity.name.function.rulec"},
        },
    }
