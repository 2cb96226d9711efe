"""Words in the texts of vocabularies and rulebooks, found by searching without parsing."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files import search_path as search
from rulec.syntax.keywords import RESERVED

_NO_WORDS = re.compile(r"#[^\n]*|\([^()]*\)|\bin\s+\S+|\bdefault\s+\S+|\bvocabulary\s+\S+")
"""Comments, parameters, units, defaults, and the vocabulary's own name."""

_DEFINED = re.compile(r"^[ \t]*(?:define|param|option)[ \t]+([^\W\d]\w*)", re.MULTILINE)

_RULE = re.compile(r"^[ \t]*(?:hard|soft|override)[ \t]+rule[ \t]+([^\W\d]\w*)", re.MULTILINE)

_TOPICS = re.compile(r"^[ \t]*topics\s*\{(.*?)\}", re.MULTILINE | re.DOTALL)
_TOPIC = re.compile(r'([^\W\d]\w*)\s+"[^"\n]*"(?:\s+of\s+([^;}]*))?')

_NAME = re.compile(r"\b[^\W\d]\w*")


def words_of_vocabularies(search_path: Sequence[Path] = ()) -> dict[str, frozenset[str]]:
    """The words that each vocabulary declares: types, signals, quantities, values."""
    words_of = {}
    for path in search.available_vocabularies(search_path):
        with suppress(RulecError):
            text = search.read_bytes(path).decode(errors="replace")
            words_of[path.stem] = frozenset(_NAME.findall(_NO_WORDS.sub(" ", text))) - RESERVED
    return words_of


def vocabularies_with(name: str, search_path: Sequence[Path] = ()) -> list[str]:
    """The vocabularies that declare a word."""
    return [book for book, words in words_of_vocabularies(search_path).items() if name in words]


def definitions_of_rulebooks(search_path: Sequence[Path] = ()) -> dict[Path, frozenset[str]]:
    """The definitions, parameters and options that the text of each rulebook itself has."""
    return {path: frozenset(_DEFINED.findall(text)) for path, text in _texts(search_path)}


def rules_of_rulebooks(search_path: Sequence[Path] = ()) -> frozenset[str]:
    """The names of the rules that the texts of rulebooks have."""
    return frozenset(name for _, text in _texts(search_path) for name in _RULE.findall(text))


def topics_of_rulebooks(search_path: Sequence[Path] = ()) -> dict[str, tuple[str, ...]]:
    """The topics that rulebooks declare, each with the rules that it lists."""
    return {
        name: tuple(_NAME.findall(rules))
        for _, text in _texts(search_path)
        for block in _TOPICS.findall(text)
        for name, rules in _TOPIC.findall(block)
    }


def _texts(search_path: Sequence[Path]) -> Iterator[tuple[Path, str]]:
    for name in search.available_rulebooks(search_path):
        path = search.find_rulebook(name, search_path)
        with suppress(RulecError):
            yield path, search.read_bytes(path).decode(errors="replace")
