"""Rulebooks as a forest: below each one those that extend it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rulec.analysis.lineage.rule_lineage import BookHeader


@dataclass(frozen=True, slots=True)
class ExtensionTree:
    """A rulebook and those that extend it directly, in alphabetical order."""

    book: BookHeader
    children: tuple[ExtensionTree, ...] = ()


def extension_forest(members: Iterable[BookHeader]) -> tuple[ExtensionTree, ...]:
    """Every rulebook once, by name, below the one that it extends.

    The roots extend none, or one that is not among them.

    Rulebooks that go round in a circle hang below the first of them by name.
    """
    by_name = {header.name: header for header in members}
    children: dict[str, list[str]] = {}
    roots = []
    for name in sorted(by_name):
        base = by_name[name].extends
        if base in by_name:
            children.setdefault(base, []).append(name)
        else:
            roots.append(name)
    placed: set[str] = set()
    trees = [_branch(name, by_name, children, placed) for name in roots]
    trees += [
        _branch(name, by_name, children, placed) for name in sorted(by_name) if name not in placed
    ]
    return tuple(sorted(trees, key=lambda header: header.book.name))


def _branch(
    name: str,
    by_name: Mapping[str, BookHeader],
    children: Mapping[str, Sequence[str]],
    placed: set[str],
) -> ExtensionTree:
    placed.add(name)
    below = [
        _branch(child, by_name, children, placed)
        for child in children.get(name, ())
        if child not in placed
    ]
    return ExtensionTree(by_name[name], tuple(below))
