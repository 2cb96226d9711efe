"""The class of road of a drive: what it is on most of the time, as far as that is told."""

from __future__ import annotations

import numpy as np

from rulec.monitoring.moments.name_tables import NameTables
from rulec.monitoring.moments.trace_truth import tables_of
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Signal, Vocabulary

MOTORWAY, BUILT_UP, OUTSIDE = "motorway", "built-up", "outside"
"""Classes of road: a motorway, any other one within built-up areas, and outside of them."""


def road_class(trace: Trace | TraceArrays, vocabulary: Vocabulary) -> str:
    """The class of most states; empty if most do not tell, or the vocabulary has no words for it.

    The words are ``motorway`` and ``built_up`` of the vocabulary ``road``.
    """
    declared = [vocabulary.declarations.get(name) for name in ("motorway", "built_up")]
    if not all(isinstance(one, Signal) and not one.parameters for one in declared):
        return ""
    tables = tables_of(trace, vocabulary)
    on_motorway, not_on_motorway = _known(tables, "motorway")
    built_up, not_built_up = _known(tables, "built_up")
    counts = {
        MOTORWAY: on_motorway.sum(),
        BUILT_UP: (not_on_motorway & built_up).sum(),
        OUTSIDE: (not_on_motorway & not_built_up).sum(),
    }
    counts[""] = tables.n_states - sum(counts.values())
    return max(counts, key=lambda name: int(counts[name]))


def _known(tables: NameTables, name: str) -> tuple[np.ndarray, np.ndarray]:
    """The states in which a signal is known to be true, and those in which it is not."""
    rows = tables.world(name)
    return rows.values[0] & ~rows.unknown[0], ~rows.values[0] & ~rows.unknown[0]
