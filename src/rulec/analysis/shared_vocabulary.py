"""The joint vocabulary of two rulebooks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

from rulec.vocabulary import Declaration, ObjectType, Vocabulary
from rulec.witnesses.object_universe import Itself
from rulec.witnesses.undecided import UndecidedError


@dataclass(frozen=True, slots=True)
class SharedVocabulary:
    """The joint vocabulary of two rulebooks; names that one lacks or defines differently."""

    vocabulary: Vocabulary
    not_shared: frozenset[str]
    unlike: frozenset[str]


def shared_vocabulary(first: Vocabulary, second: Vocabulary) -> SharedVocabulary:
    """The joint vocabulary of two vocabularies.

    A declaration has no default where the two differ, so that traces state the value; it is
    constant or presumed only if it is so in both. Raises UndecidedError.
    """
    return _shared_vocabulary(Itself(first), Itself(second))


# Cached: all rules of two rulebooks share it, and facts derived from its axioms are stored with it.
@lru_cache(maxsize=8)
def _shared_vocabulary(own: Itself[Vocabulary], other: Itself[Vocabulary]) -> SharedVocabulary:
    first, second = own.item, other.item
    types: dict[str, ObjectType] = dict(first.types)
    for name, kind in second.types.items():
        if types.setdefault(name, kind).parent != kind.parent:
            raise UndecidedError(f"`{name}` is a different type in the two")
    declarations: dict[str, Declaration] = dict(first.declarations)
    unlike = set()
    for name, item in second.declarations.items():
        known = declarations.setdefault(name, item)
        if known == item:
            continue
        if _kind(known) != _kind(item):
            unlike.add(name)
        else:
            declarations[name] = replace(
                _kind(known) if known.default != item.default else known,
                constant=known.constant and item.constant,
                presumed=known.default == item.default and known.presumed and item.presumed,
            )
    not_shared = frozenset(first.declarations.keys() ^ second.declarations.keys())
    vocabulary = Vocabulary(first.name, types, declarations)
    return SharedVocabulary(vocabulary, not_shared, frozenset(unlike))


def _kind(item: Declaration) -> Declaration:
    return replace(item, default=None, constant=False, presumed=False)
