"""The rulebooks and vocabularies that there are, by name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files.search_path import (
    available_rulebooks,
    available_vocabularies,
    find_rulebook,
    read_bytes,
)
from rulec.syntax import decode, parse, tree


@dataclass(frozen=True, slots=True)
class Entry:
    """Entry of a catalogue: a file's name, title and path."""

    name: str
    title: str
    path: Path


def list_rulebooks(search_path: Sequence[Path] = ()) -> list[Entry]:
    """The rulebooks with their titles; one that cannot be read has none."""
    paths = {name: find_rulebook(name, search_path) for name in available_rulebooks(search_path)}
    return [Entry(name, _title(_tree(path)), path) for name, path in paths.items()]


def rulebook_trees(search_path: Sequence[Path] = ()) -> list[tree.File]:
    """Syntax trees of all readable rulebooks, by name, in alphabetical order."""
    paths = (find_rulebook(name, search_path) for name in available_rulebooks(search_path))
    return [file for path in paths if (file := _tree(path)) is not None and file.name is not None]


def list_vocabularies(search_path: Sequence[Path] = ()) -> list[Entry]:
    """The vocabularies with what they declare."""
    return [
        Entry(path.stem, _declares(_tree(path)), path)
        for path in available_vocabularies(search_path)
    ]


def _tree(path: Path) -> tree.File | None:
    try:
        return parse(decode(str(path), read_bytes(path)))[0]
    except RulecError:
        return None


def _title(file: tree.File | None) -> str:
    return file.title.text.value if file is not None and file.title is not None else ""


_PLURALS = {
    tree.TypeItem: ("type", "types"),
    tree.EnumerationItem: ("enumeration", "enumerations"),
    tree.SignalItem: ("signal", "signals"),
    tree.QuantityItem: ("quantity", "quantities"),
    tree.FactItem: ("fact", "facts"),
}


def _declares(file: tree.File | None) -> str:
    counts: Counter[type] = Counter()
    for item in () if file is None else file.items:
        counts[type(item)] += len(item.signals) if isinstance(item, tree.SignalItem) else 1
    parts = [f"{counts[kind]} {words[counts[kind] != 1]}" for kind, words in _PLURALS.items()]
    return ", ".join(part for part in parts if not part.startswith("0 "))
