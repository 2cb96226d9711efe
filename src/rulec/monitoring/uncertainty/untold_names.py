"""Names that a source of traces does not tell."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN


def untold_names(vocabulary: Vocabulary, told: frozenset[str] | None) -> frozenset[str]:
    """The names that a source which tells these cannot tell, and that are not presumed."""
    if told is None:
        return frozenset()
    names = vocabulary.declarations.items()
    return frozenset(name for name, item in names if name not in told and not item.presumed)


def with_untold(vocabulary: Vocabulary, untold: frozenset[str]) -> Vocabulary:
    """The vocabulary in which untold names are unknown where no state says them."""
    if not untold:
        return vocabulary
    unknown: Any = UNKNOWN
    declarations = {
        name: replace(item, default=unknown) if name in untold else item
        for name, item in vocabulary.declarations.items()
    }
    return replace(vocabulary, declarations=declarations)
