"""The phrases of shipped vocabularies: how sentences express their words, by language."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol

from rulec.diagnostics import Source
from rulec.resources import rulebooks_folder
from rulec.rulebook.files.reference_messages import NAME_NOT_FOUND
from rulec.rulebook.rulebook_model import SourceFile
from rulec.toml import parsed_toml


class HasSources(Protocol):
    """A rulebook, compiled or not, which knows its source files."""

    @property
    def sources(self) -> Sequence[SourceFile]:
        """The files."""


def phrases_of(rulebook: HasSources, language: str = "en") -> Mapping[str, str]:
    """The phrases for the words of a rulebook, by the names of signals, values and quantities.

    They are those of the unchanged shipped vocabularies and rulebooks that it uses, from
    ``vocabulary/phrases``; its own words have none.
    """
    phrases: dict[str, str] = {}
    for name in _vocabularies(rulebook):
        phrases.update(phrases_in(name, language))
    return phrases


def types_of(rulebook: HasSources, language: str) -> Mapping[str, Sequence[str]]:
    """The words for the types of a rulebook, as in ``TypeWords``.

    There are none for its own types, and none in English, which has rules.
    """
    types: dict[str, Sequence[str]] = {}
    for name in _vocabularies(rulebook):
        types.update(_file(f"{name}.{language}.toml").get("types", {}))
    return types


def _vocabularies(rulebook: HasSources) -> Iterator[str]:
    """The shipped vocabularies and rulebooks with phrases that a rulebook uses unchanged."""
    for source in rulebook.sources:
        file = Path(source.name)
        folders = ["vocabulary"]
        if _file_of(f"{file.stem}.en.toml").is_file():
            folders.append(file.stem)
        for folder in folders:
            path = rulebooks_folder() / folder / file.name
            if path.is_file() and sha256(path.read_bytes()).hexdigest() == source.sha256:
                yield path.stem


def phrases_in(vocabulary: str, language: str) -> Mapping[str, str]:
    """The phrases of a shipped vocabulary; none if it has none in that language."""
    words = _file(f"{vocabulary}.{language}.toml").items()
    return {name: phrase for name, phrase in words if isinstance(phrase, str)}


def vocabularies_with_phrases() -> Sequence[str]:
    """The shipped vocabularies that have phrases in English."""
    files = _file_of("").glob("*.en.toml")
    names = (file.name.removesuffix(".en.toml") for file in files)
    return sorted(name for name in names if name != "titles")


def titles_in(language: str) -> Mapping[str, str]:
    """The titles of shipped rules, by name; in English only those that need one."""
    titles = _file(f"titles.{language}.toml").items()
    return {name: title for name, title in titles if isinstance(title, str)}


def topics_in(language: str) -> Mapping[str, str]:
    """The titles of shipped topics, by name; none in English, where the source has them."""
    topics: Mapping[str, str] = _file(f"titles.{language}.toml").get("topics", {})
    return topics


def topic_groups() -> Mapping[str, Sequence[str]]:
    """What shipped topics are about: a word, such as overtaking, and the topics below it."""
    groups: Mapping[str, Sequence[str]] = _file("titles.en.toml")["groups"]
    return groups


def synonyms_of_the_field() -> Mapping[str, Sequence[str]]:
    """The words of shipped vocabularies, with synonyms in any language."""
    return _file("synonyms.toml")


def _file_of(name: str) -> Path:
    return rulebooks_folder() / "vocabulary" / "phrases" / name


@cache
def _file(name: str) -> Mapping[str, Any]:
    path = _file_of(name)
    if not path.is_file():
        return MappingProxyType({})
    text = path.read_text(encoding="utf-8")
    how = 'write `name = "ego [is|is not] …"`'
    return MappingProxyType(parsed_toml(Source(str(path), text), NAME_NOT_FOUND, how))
