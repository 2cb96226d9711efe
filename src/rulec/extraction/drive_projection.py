"""What is said of a drive, as far as a rulebook's vocabulary has words for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rulec.extraction.signals.signal_columns import Column, SignalColumns
from rulec.partition.cell_valuations import PAPER_SURFACE
from rulec.trace.vocabulary_projection import could_mean, known_types
from rulec.vocabulary import Declaration, Enumeration, Vocabulary

UNITS = {
    "speed": "km/h",
    "limit": "km/h",
    "speed_difference": "km/h",
    "gap": "m",
    "time_headway": "s",
    "lateral_gap": "m",
    "distance_to_crossing": "m",
    "ego_length": "m",
}
"""The units of the quantities that recordings supply."""


def fitted(
    words: SignalColumns,
    kinds: Sequence[Sequence[str]],
    vocabulary: Vocabulary,
    names: frozenset[str] | None,
) -> SignalColumns:
    """The words that a vocabulary knows, only those among ``names`` if that is given.

    ``kinds`` are the types of the objects, a row each, the most specific first.
    """
    world, about, only = {}, {}, dict(words.only)
    for name, declaration in vocabulary.declarations.items():
        if names is not None and name not in names:
            continue
        if name in words.world and not declaration.parameters:
            column = _spelled(name, words.world[name], declaration)
            if _fits(name, column, declaration):
                world[name] = column
        if name in words.about and len(declaration.parameters) == 1:
            column = words.about[name]
            if _fits(name, column, declaration):
                about[name] = column
                (wanted,) = declaration.parameters
                own = np.array([_is(types, wanted, vocabulary) for types in kinds], dtype=bool)
                only[name] = own & only.get(name, True)
    return SignalColumns(world, about, words.unknown, only)


def _spelled(name: str, column: Column, declaration: Declaration) -> Column:
    """The paper has words of its own for surfaces, and only two of them."""
    if name != "surface" or not isinstance(declaration, Enumeration):
        return column
    if not set(PAPER_SURFACE.values()).issuperset(declaration.values):
        return column
    return np.array([PAPER_SURFACE.get(one, "R_cw") for one in column.tolist()])


def _fits(name: str, column: Column, declaration: Declaration) -> bool:
    # All numbers are alike; the values of others are few
    some = column.ravel()[:1] if column.dtype.kind == "f" else np.unique(column)
    return could_mean(some.tolist(), declaration, UNITS.get(name, ""))


def _is(types: Sequence[str], wanted: str, vocabulary: Vocabulary) -> bool:
    known = next((one for one in types if one in vocabulary.types), None)
    return known is not None and vocabulary.is_subtype(known, wanted)


def named_types(
    kinds: Mapping[str, Sequence[str]], vocabulary: Vocabulary | None
) -> dict[str, str]:
    """The types of objects by name; without a vocabulary the most specific ones."""
    if vocabulary is None:
        return {name: types[0] for name, types in kinds.items()}
    return known_types(kinds, vocabulary)
