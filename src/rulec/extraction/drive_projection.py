"""Projection of a drive's signals onto what a rulebook's vocabulary declares."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.partition.cell_graph import PAPER_SURFACE
from rulec.trace.vocabulary_projection import fits, is_about, known_type
from rulec.vocabulary import Declaration, Enumeration, Vocabulary


def project_columns(
    signals: SignalColumns,
    types: Sequence[Sequence[str]],
    vocabulary: Vocabulary,
    names: frozenset[str] | None,
) -> SignalColumns:
    """The signals that a vocabulary declares, optionally only those in ``names``.

    ``types`` are those of the objects, a row each, the most specific first.
    """
    own_types = [known_type(row, vocabulary) for row in types]
    world, about, only = {}, {}, dict(signals.only)
    for name, declaration in vocabulary.declarations.items():
        if names is not None and name not in names:
            continue
        if name in signals.world and not declaration.parameters:
            column = _in_paper_words(name, signals.world[name], declaration)
            if _fits(name, column, declaration):
                world[name] = column
        if name in signals.about and len(declaration.parameters) == 1:
            column = signals.about[name]
            if _fits(name, column, declaration):
                about[name] = column
                meant = [is_about(declaration, own, vocabulary) for own in own_types]
                only[name] = np.array(meant, dtype=bool) & only.get(name, True)
    return SignalColumns(world, about, signals.unknown, only)


def _in_paper_words(name: str, column: SignalColumn, declaration: Declaration) -> SignalColumn:
    """Surfaces in the paper's two words, for vocabularies with only those."""
    if name != "surface" or not isinstance(declaration, Enumeration):
        return column
    if not set(PAPER_SURFACE.values()).issuperset(declaration.values):
        return column
    return np.array([PAPER_SURFACE.get(surface, "R_cw") for surface in column.tolist()])


def _fits(name: str, column: SignalColumn, declaration: Declaration) -> bool:
    # All floats are alike; the distinct values of others are few
    values = column.ravel()[:1] if column.dtype.kind == "f" else np.unique(column)
    return fits(name, values.tolist(), declaration)
