"""Choices of distinct objects for variables of some types."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations, product

from rulec.vocabulary.vocabulary_model import Vocabulary


def choices(
    types: Sequence[str], objects: Mapping[str, str], vocabulary: Vocabulary
) -> Iterator[tuple[str, ...]]:
    """All choices of distinct objects for the types.

    ``objects`` maps each object to its type.

    An object of a subtype fits, too. Of no types there is one choice, the empty one.
    """
    fitting = [
        [item for item, kind in objects.items() if vocabulary.is_subtype(kind, wanted)]
        for wanted in types
    ]
    if len(set(types)) == 1:
        yield from permutations(fitting[0], len(types))
        return
    for chosen in product(*fitting):
        if len(set(chosen)) == len(chosen):
            yield chosen
