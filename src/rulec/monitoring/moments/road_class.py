"""The road class of drives: that of most of their states, as far as it is known."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags
from rulec.monitoring.moments.name_tables import NameTables
from rulec.trace.partly_known.partly_known_values import EnumeratedChoice, Truth
from rulec.vocabulary import Enumeration, Signal

MOTORWAY, BUILT_UP, OUTSIDE = "motorway", "built-up", "outside"
"""Road classes: motorways, other roads within built-up areas, and other roads outside of them."""


def road_classes(tables: NameTables) -> list[str]:
    """For each trace the road class of most of its states.

    It is empty if most states do not tell, or if the vocabulary lacks the words ``motorway`` and
    ``built_up`` of the vocabulary ``road``: signals, or values of an enumeration.
    """
    there = np.arange(tables.n_states) <= tables.last[:, None]
    told = [_known(tables, name, there) for name in ("motorway", "built_up")]
    if None in told:
        return [""] * tables.n_traces
    (on_motorway, not_on_motorway), (built_up, not_built_up) = filter(None, told)
    counts = {
        MOTORWAY: on_motorway.sum(axis=1),
        BUILT_UP: (not_on_motorway & built_up).sum(axis=1),
        OUTSIDE: (not_on_motorway & not_built_up).sum(axis=1),
    }
    counts[""] = tables.last + 1 - sum(counts.values())
    most = np.argmax(list(counts.values()), axis=0)
    return [[*counts][place] for place in most.tolist()]


def _known(tables: NameTables, name: str, there: Flags) -> tuple[Flags, Flags] | None:
    """The states in which a word is known to hold, and known not to; None if it is no such word."""
    declared = tables.vocabulary.declarations.get(name) or tables.vocabulary.enumeration_of.get(
        name
    )
    if not isinstance(declared, Signal | Enumeration) or declared.parameters:
        return None
    rows = tables.world(declared.name)
    if isinstance(declared, Enumeration) and isinstance(rows, EnumeratedChoice):
        rows = rows.equals(declared.values.index(name))
    assert isinstance(rows, Truth), "a signal has one"
    return there & rows.sure, there & ~rows.possible
