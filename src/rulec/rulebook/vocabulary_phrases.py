"""Phrases of the vocabularies that ship: how sentences speak of their words, by language."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType

from rulec.diagnostics import Source
from rulec.resources import rulebooks_folder
from rulec.rulebook.files.reference_messages import NAME_NOT_FOUND
from rulec.rulebook.rulebook_model import Rulebook
from rulec.toml import parsed_toml

LANGUAGES = ("en", "de", "fr")


def phrases_of(rulebook: Rulebook, language: str = "en") -> Mapping[str, str]:
    """The phrases for the words of a rulebook, by the names of signals, values and quantities.

    They are those of the vocabularies that it uses as they ship, from ``vocabulary/phrases``; none
    for words of its own.
    """
    phrases: dict[str, str] = {}
    for source in rulebook.sources:
        path = rulebooks_folder() / "vocabulary" / Path(source.name).name
        if path.is_file() and sha256(path.read_bytes()).hexdigest() == source.sha256:
            phrases.update(phrases_in(path.stem, language))
    return phrases


@cache
def phrases_in(vocabulary: str, language: str) -> Mapping[str, str]:
    """The phrases of a vocabulary that ships; none if it has none in that language."""
    folder = rulebooks_folder() / "vocabulary" / "phrases"
    path = folder / f"{vocabulary}.{language}.toml"
    if not path.is_file():
        return MappingProxyType({})
    text = path.read_text(encoding="utf-8")
    how = 'write `name = "ego [is|is not] …"`'
    return MappingProxyType(parsed_toml(Source(str(path), text), NAME_NOT_FOUND, how))
