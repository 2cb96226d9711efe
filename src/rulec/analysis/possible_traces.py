"""Whether all that is known of every state holds in a trace, for all of its objects."""

from __future__ import annotations

from dataclasses import replace

from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView
from rulec.trace import Trace
from rulec.witnesses.object_universe import ObjectUniverse


def is_possible(trace: Trace, universe: ObjectUniverse) -> bool:
    """Whether no axiom of the universe is false in the trace, whose objects may be more."""
    bound = list(replace(universe, objects=trace.objects).axiom_bindings())
    views = [StateView(state, trace.objects, universe.vocabulary) for state in trace.states]
    return all(
        holds(axiom.formula, names, view) is not False for view in views for axiom, names in bound
    )
