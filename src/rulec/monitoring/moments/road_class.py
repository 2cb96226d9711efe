"""The road class of drives: that of most of their states, as far as it is known."""

from __future__ import annotations

import numpy as np

from rulec.monitoring.moments.name_tables import Flags, NameTables
from rulec.vocabulary import Signal

MOTORWAY, BUILT_UP, OUTSIDE = "motorway", "built-up", "outside"
"""Road classes: motorways, other roads within built-up areas, and other roads outside of them."""


def road_classes(tables: NameTables) -> list[str]:
    """For each trace the road class of most of its states.

    It is empty if most states do not tell, or if the vocabulary lacks the signals, which are
    ``motorway`` and ``built_up`` of the vocabulary ``road``.
    """
    declared = [tables.vocabulary.declarations.get(name) for name in ("motorway", "built_up")]
    if not all(isinstance(signal, Signal) and not signal.parameters for signal in declared):
        return [""] * tables.n_traces
    there = np.arange(tables.n_states) <= tables.last[:, None]
    on_motorway, not_on_motorway = _known(tables, "motorway", there)
    built_up, not_built_up = _known(tables, "built_up", there)
    counts = {
        MOTORWAY: on_motorway.sum(axis=1),
        BUILT_UP: (not_on_motorway & built_up).sum(axis=1),
        OUTSIDE: (not_on_motorway & not_built_up).sum(axis=1),
    }
    counts[""] = tables.last + 1 - sum(counts.values())
    most = np.argmax(list(counts.values()), axis=0)
    return [[*counts][place] for place in most.tolist()]


def _known(tables: NameTables, name: str, there: Flags) -> tuple[Flags, Flags]:
    """The states in which a signal is known to be true, and known to be false."""
    rows = tables.world(name)
    known = there & ~rows.unknown
    return rows.values & known, ~rows.values & known
