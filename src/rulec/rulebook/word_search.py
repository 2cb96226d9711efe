"""Finds words by name alone, in whichever vocabulary or rulebook declares them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.rulebook.files import search_path as search
from rulec.rulebook.files.words_in_files import definitions_of_rulebooks, vocabularies_with
from rulec.rulebook.loader import Trees, find, parse_all
from rulec.rulebook.names.constant_and_presumed import mark_constant_and_presumed
from rulec.rulebook.names.symbol_table import SymbolTable, symbol_table
from rulec.syntax import decode, tree
from rulec.syntax.caching.tree_cache import parsed
from rulec.syntax.keywords import ITEM_WORDS

_DECLARATIONS = re.compile(
    r"(?:\b(?:type|signal|quantity)\b|\b\w+\s*(?:\([^()]*\)\s*)?\bis\s+one\s+of\b)"
    rf".*?(?=^[ \t]*(?:{'|'.join(sorted(ITEM_WORDS))})\b|\Z)",
    re.MULTILINE | re.DOTALL,
)
"""Whatever may declare words; a rulebook that has a word nowhere there is not parsed."""

Defined = tree.DefineItem | tree.ParamItem | tree.OptionItem


@dataclass(frozen=True, slots=True)
class FoundWord:
    """A word, the file that declares it, and all declarations there and in what it uses."""

    name: str
    file: tree.File
    vocabularies: tuple[tree.File, ...]
    symbols: SymbolTable


def find_word(name: str, search_path: Sequence[Path] = ()) -> list[FoundWord]:
    """The vocabularies that declare a word; if there are none, the rulebooks that do.

    A definition, a parameter or an option of a rulebook is found, too.
    """
    return (
        [*_in_vocabularies(name, search_path)]
        or [*_definitions(name, search_path)]
        or [*_in_rulebooks(name, search_path)]
    )


def definition_in(file: tree.File, name: str) -> Defined | None:
    """The definition, parameter or option of a name in a rulebook's own text."""
    return next(
        (item for item in file.items if isinstance(item, Defined) and item.name.text == name), None
    )


def _definitions(name: str, search_path: Sequence[Path]) -> Iterator[FoundWord]:
    for path, names in definitions_of_rulebooks(search_path).items():
        if name in names:
            with suppress(RulecError):
                file = parsed(decode(str(path), search.read_bytes(path)))[0]
                if definition_in(file, name) is not None:
                    yield FoundWord(name, file, (), SymbolTable())


def _in_vocabularies(name: str, search_path: Sequence[Path]) -> Iterator[FoundWord]:
    named = vocabularies_with(name, search_path)
    for path in search.available_vocabularies(search_path):
        if path.stem in named:
            with suppress(RulecError):
                file = parsed(decode(str(path), search.read_bytes(path)))[0]
                if _declares(file, name):
                    yield FoundWord(name, file, (file,), _symbols((file,)))


def _in_rulebooks(name: str, search_path: Sequence[Path]) -> Iterator[FoundWord]:
    for book in search.available_rulebooks(search_path):
        trees = _trees_with(name, book, search_path)
        if trees is not None and _declares(trees.books[-1], name):
            symbols = _symbols((*trees.vocabularies, *trees.books))
            yield FoundWord(name, trees.books[-1], trees.vocabularies, symbols)


def _trees_with(name: str, book: str, search_path: Sequence[Path]) -> Trees | None:
    """The trees of a rulebook whose text may declare a word."""
    with suppress(RulecError):
        file = find(book, search_path)
        word = re.compile(rf"\b{re.escape(name)}\b")
        declarations = _DECLARATIONS.findall(file.source.text)
        return parse_all(file) if any(map(word.search, declarations)) else None
    return None


def _symbols(files: Sequence[tree.File]) -> SymbolTable:
    symbols = symbol_table(files)
    mark_constant_and_presumed(symbols, files)
    return symbols


def _declares(file: tree.File, name: str) -> bool:
    return any(name == declared.text for item in file.items for declared in _declared(item))


def _declared(item: tree.Item) -> Iterator[tree.Name]:
    match item:
        case tree.TypeItem(name) | tree.QuantityItem(name):
            yield name
        case tree.ParamItem(name) | tree.DefineItem(name, again=False):
            yield name
        case tree.SignalItem(signals):
            yield from (head.name for head in signals)
        case tree.EnumerationItem():
            yield from (item.name, *item.values)
