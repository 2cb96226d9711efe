"""Values that a state omits and that axioms imply."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from operator import is_
from typing import Any

from rulec.monitoring.constant_values import values_in, with_constants
from rulec.monitoring.state_view import put
from rulec.trace import State, Trace, TraceGraph
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN


def with_derived_values(
    trace: Trace, vocabulary: Vocabulary, where: Callable[[int], str] = "state {}".format
) -> Trace:
    """The trace ``with_constants`` and ``with_implied_values``. Raises RulecError R0503."""
    return with_implied_values(with_constants(trace, vocabulary, where), vocabulary)


def with_implied_values(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace of valid states, extended by what follows by ``Vocabulary.implied``."""
    if not vocabulary.implied:
        return trace
    states = tuple([with_implied_signals(state, vocabulary) for state in trace.states])
    same = all(map(is_, states, trace.states))
    return trace if same else replace(trace, states=states)


def with_implied_in_graph(graph: TraceGraph, vocabulary: Vocabulary) -> TraceGraph:
    """The graph of valid states, extended by what follows by ``Vocabulary.implied``."""
    if not vocabulary.implied:
        return graph
    layers = [[with_implied_signals(state, vocabulary) for state in own] for own in graph.states]
    return replace(graph, states=tuple(map(tuple, layers)))


def with_implied_signals(state: State, vocabulary: Vocabulary) -> State:
    """The state, extended by each signal that it omits and that follows from a true one.

    Values in the state are kept: if one contradicts an axiom, the state still does.
    """
    implied = vocabulary.implied
    if implied.keys().isdisjoint(state):
        return state
    filled: dict[str, Any] = dict(state)
    ahead = [
        (cause, items)
        for cause in implied.keys() & state.keys()
        for items in _true_of(state[cause], len(vocabulary.declarations[cause].parameters))
    ]
    while ahead:
        cause, items = ahead.pop()
        for effect in implied.get(cause, ()):
            if not _mentions(filled.get(effect), items):
                filled[effect] = put(filled.get(effect), items, True)
                ahead.append((effect, items))
    return state if filled == state else filled


def _true_of(given: Any, depth: int) -> list[tuple[str, ...]]:
    """The objects for which a signal is true."""
    if depth == 1 and type(given) is dict:
        return [(item,) for item, value in given.items() if value is True]
    return [items for items, value in values_in(given, depth) if value is True]


def _mentions(value: Any, items: tuple[str, ...]) -> bool:
    for item in items:
        if value is UNKNOWN:
            return True
        value = value.get(item) if isinstance(value, Mapping) else None
    return value is not None
