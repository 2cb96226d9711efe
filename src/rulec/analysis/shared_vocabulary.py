"""The joint vocabulary of two rulebooks."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.vocabulary import Declaration, ObjectType, Vocabulary
from rulec.witnesses.undecided import UndecidedError


@dataclass(frozen=True, slots=True)
class SharedVocabulary:
    """The joint vocabulary of two rulebooks.

    Also the declarations that one of them lacks, and names for what is not alike in both.
    """

    vocabulary: Vocabulary
    not_shared: frozenset[str]
    unlike: frozenset[str]


def shared_vocabulary(first: Vocabulary, second: Vocabulary) -> SharedVocabulary:
    """The words of two vocabularies together.

    Where defaults differ there is none, so that traces say the value. Raises UndecidedError if a
    type is not the same in both.
    """
    types: dict[str, ObjectType] = dict(first.types)
    for name, kind in second.types.items():
        if types.setdefault(name, kind).parent != kind.parent:
            raise UndecidedError(f"`{name}` is not the same type in both")
    declarations: dict[str, Declaration] = dict(first.declarations)
    unlike = set()
    for name, item in second.declarations.items():
        known = declarations.setdefault(name, item)
        if replace(known, default=None) != replace(item, default=None):
            unlike.add(name)
        elif known.default != item.default:
            declarations[name] = replace(known, default=None)
    not_shared = frozenset(first.declarations.keys() ^ second.declarations.keys())
    vocabulary = Vocabulary(first.name, types, declarations)
    return SharedVocabulary(vocabulary, not_shared, frozenset(unlike))
