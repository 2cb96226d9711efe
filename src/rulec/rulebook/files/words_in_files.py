"""Words in the texts of vocabularies and rulebooks, found by searching without parsing."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files import search_path as search
from rulec.syntax.keywords import RESERVED

_NO_WORDS = re.compile(r"#[^\n]*|\([^()]*\)|\bin\s+\S+|\bdefault\s+\S+|\bvocabulary\s+\S+")
"""Comments, parameters, units, defaults, and the vocabulary's own name."""

_BODY = re.compile(
    r"^([ \t]*(?:define|param)[ \t]+\w+).*?"
    r"(?=^[ \t]*(?:[#}]|(?:define|param|type|signal|quantity|fact|constant|presumed)\b"
    r"|\w+\s*(?:\([^()]*\)\s*)?is\s+one\s+of\b)|\Z)",
    re.MULTILINE | re.DOTALL,
)
"""A definition or a parameter, whose body declares nothing."""

_DEFINED = re.compile(r"^[ \t]*(?:define|param|option)[ \t]+([^\W\d]\w*)", re.MULTILINE)

_RULE = re.compile(r"^[ \t]*(?:hard|soft|override)[ \t]+rule[ \t]+([^\W\d]\w*)", re.MULTILINE)

_ITEM = re.compile(
    r"^[ \t]*(?:(?:hard|soft|override)[ \t]+(rule)|(?:re)?define|param|set)[ \t]+([^\W\d]\w*)"
    r"(.*?)(?=^[ \t]*(?:hard|soft|override|soften|drop|silent|define|redefine|param|set)\b|\Z)",
    re.MULTILINE | re.DOTALL,
)
"""A rule, or what gives a name a meaning, with its text."""

_NOT_READ = re.compile(r'"[^"\n]*"|#[^\n]*|\b(?:accept|reject)\b[^{]*\{[^}]*\}')

_EXTENDS = re.compile(r"^[ \t]*extends[ \t]+([\w-]+)", re.MULTILINE)

_TOPICS = re.compile(r"^[ \t]*topics\s*\{(.*?)\}", re.MULTILINE | re.DOTALL)
_TOPIC = re.compile(r'([^\W\d]\w*)\s+"[^"\n]*"(?:\s+of\s+([^;}]*))?')

_NAME = re.compile(r"\b[^\W\d]\w*")


def words_of_vocabularies(search_path: Sequence[Path] = ()) -> dict[str, frozenset[str]]:
    """The words that each vocabulary declares: types, signals, quantities, values."""
    words_of = {}
    for path in search.available_vocabularies(search_path):
        with suppress(RulecError):
            text = search.read_bytes(path).decode(errors="replace")
            text = _BODY.sub(r"\1 ", text)
            words_of[path.stem] = frozenset(_NAME.findall(_NO_WORDS.sub(" ", text))) - RESERVED
    return words_of


def vocabularies_with(name: str, search_path: Sequence[Path] = ()) -> list[str]:
    """The vocabularies that declare a word."""
    return [book for book, words in words_of_vocabularies(search_path).items() if name in words]


def definitions_of_rulebooks(search_path: Sequence[Path] = ()) -> dict[Path, frozenset[str]]:
    """The definitions, parameters and options that the text of each rulebook itself has."""
    return {
        path: frozenset(_DEFINED.findall(text)) for path, text in search.rulebook_texts(search_path)
    }


def rules_of_rulebooks(search_path: Sequence[Path] = ()) -> frozenset[str]:
    """The names of the rules that the texts of rulebooks have."""
    return frozenset(
        name for _, text in search.rulebook_texts(search_path) for name in _RULE.findall(text)
    )


def topics_of_rulebooks(search_path: Sequence[Path] = ()) -> dict[str, tuple[str, ...]]:
    """The topics that rulebooks declare, each with the rules that it lists."""
    return {
        name: tuple(_NAME.findall(rules))
        for _, text in search.rulebook_texts(search_path)
        for block in _TOPICS.findall(text)
        for name, rules in _TOPIC.findall(block)
    }


def rules_reading(
    words: Collection[str], search_path: Sequence[Path] = ()
) -> dict[str, tuple[str, ...]]:
    """The rules in each rulebook's own text that read one of these words.

    They may also read it by a name that is defined there, or in a rulebook that it extends.
    """
    texts = {path.stem: text for path, text in search.rulebook_texts(search_path)}
    bases = {book: _EXTENDS.findall(text) for book, text in texts.items()}
    rules: dict[str, dict[str, frozenset[str]]] = {}
    meanings: dict[str, dict[str, frozenset[str]]] = {}
    for book, text in texts.items():
        rules[book], meanings[book] = {}, {}
        for rule, name, body in _ITEM.findall(text):
            read = frozenset(_NAME.findall(_NOT_READ.sub(" ", body)))
            (rules if rule else meanings)[book][name] = read
    found = {}
    for book in texts:
        chain = [book]
        while (base := next(iter(bases.get(chain[-1], ())), "")) in texts and base not in chain:
            chain.append(base)
        known = {name: read for one in reversed(chain) for name, read in meanings[one].items()}
        reading, before = {*words}, 0
        while len(reading) > before:
            before = len(reading)
            reading |= {name for name, read in known.items() if not read.isdisjoint(reading)}
        own = tuple(name for name, read in rules[book].items() if not read.isdisjoint(reading))
        if own:
            found[book] = own
    return found
