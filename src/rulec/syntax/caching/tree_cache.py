"""A cache of syntax trees by their text."""

from __future__ import annotations

from dataclasses import is_dataclass
from typing import Any

from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.stored_objects import KeptObjects, ObjectCodec, kinds_of_fields
from rulec.diagnostics import Diagnostic, Source, Span
from rulec.syntax import tree
from rulec.syntax.parser import parse

MOST_TREES = 200
"""How many trees are kept; the longest unused ones are removed first."""

_NODES: list[type[Any]] = [
    kind
    for _, kind in sorted(vars(tree).items())
    if isinstance(kind, type) and is_dataclass(kind) and kind.__module__ == tree.__name__
]
TREES = ObjectCodec(kinds_of_fields([*_NODES, Span]))
"""A tree is written with its source and ``NOWHERE`` as given objects."""


def parsed(source: Source, *, keeps: bool = True) -> tuple[tree.File, tuple[Diagnostic, ...]]:
    """The result of ``parse`` for a text, from the cache if possible; otherwise it is added.

    Unless ``keeps``, it is not added: what is made from the tree is kept instead.
    """
    kept = KeptObjects(KeptBytes("tree", MOST_TREES), TREES)
    if not kept.files.can_be:
        return parse(source)
    key, given = kept.files.key(source.text), (source, tree.NOWHERE)
    known = kept.recall(key, given)
    if isinstance(known, tree.File):
        return known, ()
    file, mistakes = parse(source)
    if keeps and not mistakes:
        kept.keep({key: file}, given)
    return file, mistakes
