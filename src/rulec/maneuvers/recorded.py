"""What a recorded scene supplies, as far as a rulebook has words for it.

Nobody has written a recording for one rulebook: its types are the most specific that the vocabulary
knows, and signals that it does not know, or means otherwise, are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from rulec.maneuvers.terms import SUPPLIED
from rulec.trace import State, TraceGraph, Value
from rulec.trace.fitting import could_mean, known_types
from rulec.vocabulary import Declaration, Vocabulary

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph

RECORDED_UNIT = "km/h"
"""The unit of the quantities that recorded scenes supply."""


def fitted(vocabulary: Vocabulary, graph: NavigationGraph) -> TraceGraph:
    """The graph's paths as traces; of a recorded scene with what the vocabulary knows of it."""
    traces = graph.trace_graph()
    if graph.scenario.account is None:
        return traces
    objects = known_types(
        {name: (one.type, *one.broader) for name, one in graph.objects.items()}, vocabulary
    )
    return replace(
        traces,
        objects=objects,
        present={name: there for name, there in traces.present.items() if name in objects},
        states=tuple(
            tuple([_state(vocabulary, objects, state) for state in layer])
            for layer in traces.states
        ),
    )


def _state(vocabulary: Vocabulary, objects: Mapping[str, str], state: State) -> State:
    kept: dict[str, Value | Mapping[str, Value]] = {}
    for name, value in state.items():
        declaration = vocabulary.declarations.get(name)
        if name not in SUPPLIED and not _fits(value, declaration):
            continue
        if isinstance(value, Mapping):
            about = declaration.parameters[0] if declaration and declaration.parameters else None
            value = {
                item: inner
                for item, inner in value.items()
                if item in objects
                and (about is None or vocabulary.is_subtype(objects[item], about))
            }
        kept[name] = value
    return kept


def _fits(value: Value | Mapping[str, Value], declaration: Declaration | None) -> bool:
    """Could this be what the vocabulary means by the name?"""
    if declaration is None or isinstance(value, Mapping) != bool(declaration.parameters):
        return False
    values = value.values() if isinstance(value, Mapping) else (value,)
    return could_mean(values, declaration, RECORDED_UNIT)
