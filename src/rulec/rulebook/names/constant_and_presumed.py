"""Marks declarations as constant or presumed, according to lines of their own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rulec.rulebook.names import declaration_messages as say
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.syntax import tree
from rulec.vocabulary import Enumeration

MOST_PRESUMED = 12
"""The most presumed names: each is listed with every verdict that rests on it."""


def mark_constant_and_presumed(symbols: SymbolTable, files: Sequence[tree.File]) -> None:
    """Mark the declarations of the names in `constant` and `presumed` lines.

    A file marks a name once; files that build upon each other may repeat the mark.
    """
    for file in files:
        seen: dict[tuple[type, str], tree.Name] = {}
        for item, name in _marked(file):
            first = seen.setdefault((type(item), name.text), name)
            if first is not name:
                symbols.mistakes.append(say.marked_twice(item, name, first.span))
            elif name.text in symbols.items:
                _mark(symbols, item, name)
            elif not symbols.may_know(name.text):
                value_of = symbols.value_of.get(name.text)
                of = "" if value_of is None else value_of.name
                symbols.mistakes.append(say.nothing_to_mark(item, name, symbols.items.keys(), of))
    for text, enumeration in symbols.value_of.items():
        now = symbols.items.get(enumeration.name)
        if isinstance(now, Enumeration):
            symbols.value_of[text] = now


def _marked(file: tree.File) -> Iterator[tuple[tree.ConstantItem | tree.PresumedItem, tree.Name]]:
    for item in file.items:
        if isinstance(item, tree.ConstantItem | tree.PresumedItem):
            yield from ((item, name) for name in item.names)


def _mark(
    symbols: SymbolTable, item: tree.ConstantItem | tree.PresumedItem, name: tree.Name
) -> None:
    declared = symbols.items[name.text]
    if isinstance(item, tree.ConstantItem):
        symbols.items[name.text] = replace(declared, constant=True)
        return
    if declared.default is None:
        if name.text not in symbols.uncertain:
            symbols.mistakes.append(say.no_default(name, symbols.spans[name.text]))
        return
    symbols.items[name.text] = replace(declared, presumed=True)
    presumed = sum(known.presumed for known in symbols.items.values())
    if presumed > MOST_PRESUMED and not declared.presumed:
        symbols.mistakes.append(say.too_many_presumed(name, presumed, MOST_PRESUMED))
