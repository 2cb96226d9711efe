"""The catalogue of available rulebooks and vocabularies."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files import search_path as search
from rulec.rulebook.files.edition_names import edition_names
from rulec.rulebook.files.referenced_files import MOST_BASES
from rulec.syntax import decode, parse_head, tree
from rulec.syntax.caching.tree_cache import parsed


@dataclass(frozen=True, slots=True)
class Entry:
    """Entry of a catalogue: a file's name, title and path."""

    name: str
    title: str
    path: Path


def list_rulebooks(search_path: Sequence[Path] = ()) -> list[Entry]:
    """The rulebooks with their titles; one that cannot be read has no title."""
    return [
        Entry(path.stem, file.title.text.value if file and file.title else "", path)
        for path in _rulebooks(search_path)
        for file in [_head(path)]
    ]


def rulebook_heads(search_path: Sequence[Path] = ()) -> list[tree.File]:
    """The header lines of all readable rulebooks, by name, in alphabetical order."""
    files = map(_head, _rulebooks(search_path))
    return [file for file in files if file is not None and file.name is not None]


def named_by_heads(references: Sequence[str], search_path: Sequence[Path] = ()) -> dict[str, str]:
    """References to rulebooks with distinct names; those that extend the fewest come first.

    Only the header lines are read; where they cannot be, the reference is the name.
    """
    chains = {reference: _chain(reference, search_path) for reference in references}
    names = [
        chain[0].name.text if chain and chain[0].name else reference
        for reference, chain in chains.items()
    ]
    files = [chain[0].span.source.name if chain else name for name, chain in chains.items()]
    named = dict(zip(chains, edition_names(names, files), strict=True))
    return {name: named[name] for name in sorted(named, key=lambda name: len(chains[name]))}


def _chain(reference: str, search_path: Sequence[Path]) -> list[tree.File]:
    """The head of a rulebook and those of the ones that it extends, as far as they can be read."""
    heads: list[tree.File] = []
    with suppress(RulecError):
        path = search.find_rulebook(reference, search_path)
        while (head := _head(path)) is not None and len(heads) <= MOST_BASES:
            heads.append(head)
            if head.extends is None:
                break
            base = head.extends.name
            path = search.find_base(base.text, base.span, path, search_path)
    return heads


def rulebooks_with_rule(name: str, search_path: Sequence[Path] = ()) -> list[str]:
    """The rulebooks whose own text has a rule of this name, not counting inherited rules."""
    rule = re.compile(rf"\brule\s+{re.escape(name)}\b", re.ASCII)
    return [path.stem for path, text in search.rulebook_texts(search_path) if rule.search(text)]


def list_vocabularies(search_path: Sequence[Path] = ()) -> list[Entry]:
    """The vocabularies with what they declare."""
    return [
        Entry(path.stem, _declares(_tree(path)), path)
        for path in search.available_vocabularies(search_path)
    ]


def _rulebooks(search_path: Sequence[Path]) -> list[Path]:
    names = search.available_rulebooks(search_path)
    return [search.find_rulebook(name, search_path) for name in names]


def _head(path: Path) -> tree.File | None:
    try:
        return parse_head(decode(str(path), search.read_bytes(path)))
    except RulecError:
        return None


def _tree(path: Path) -> tree.File | None:
    try:
        return parsed(decode(str(path), search.read_bytes(path)))[0]
    except RulecError:
        return None


_WORDS = {
    tree.TypeItem: ("type", "types"),
    tree.EnumerationItem: ("enumeration", "enumerations"),
    tree.SignalItem: ("signal", "signals"),
    tree.QuantityItem: ("quantity", "quantities"),
    tree.FactItem: ("fact", "facts"),
    tree.ConstantItem: ("constant", "constants"),
    tree.PresumedItem: ("presumption", "presumptions"),
}


def _declares(file: tree.File | None) -> str:
    counts: Counter[type] = Counter()
    for item in () if file is None else file.items:
        match item:
            case (
                tree.SignalItem(signals=names) | tree.ConstantItem(names) | tree.PresumedItem(names)
            ):
                counts[type(item)] += len(names)
            case _:
                counts[type(item)] += 1
    parts = [f"{counts[kind]} {words[counts[kind] != 1]}" for kind, words in _WORDS.items()]
    return ", ".join(part for part in parts if not part.startswith("0 "))
