"""Values that states omit and that follow from others: by axioms, or by the meanings of words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from operator import is_
from typing import Any

from rulec.automata.thresholds import exact_step
from rulec.logic import formula as ltl
from rulec.logic.bounds import in_steps
from rulec.logic.fold import fold
from rulec.logic.kleene import Unknown, evaluator_of
from rulec.monitoring.bindings import binding_of
from rulec.monitoring.constant_values import values_in, with_constants
from rulec.monitoring.state_view import StateView, put, value_in
from rulec.monitoring.told_names import untold_names, with_meant, with_untold, words_meant
from rulec.trace import State, Trace, TraceGraph
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.partly_known.temporal_operators import BitInstants
from rulec.trace.trace_model import present_in
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN
from rulec.vocabulary.vocabulary_model import choices


def with_derived_values(
    trace: Trace, vocabulary: Vocabulary, where: Callable[[int], str] = "state {}".format
) -> Trace:
    """The trace with its constants, what facts imply, and the words that are defined.

    Raises RulecError R0503.
    """
    trace = with_implied_values(with_constants(trace, vocabulary, where), vocabulary)
    return with_defined_words(trace, vocabulary)


def with_implied_values(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace of valid states, extended by what follows by ``Vocabulary.implied``."""
    if not vocabulary.implied:
        return trace
    states = tuple([with_implied_signals(state, vocabulary) for state in trace.states])
    same = all(map(is_, states, trace.states))
    return trace if same else replace(trace, states=states)


def with_implied_in_graph(graph: TraceGraph, vocabulary: Vocabulary) -> TraceGraph:
    """The graph of valid states, extended by what facts imply and by the words that are defined."""
    graph = with_words_in_graph(graph, vocabulary)
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
    filled: dict[str, Any] = {}
    ahead = [
        (cause, items)
        for cause in implied.keys() & state.keys()
        for items in _true_of(state[cause], len(vocabulary.declarations[cause].parameters))
    ]
    while ahead:
        cause, items = ahead.pop()
        for effect in implied.get(cause, ()):
            known = filled.get(effect, state.get(effect))
            if not _mentions(known, items):
                filled[effect] = put(known, items, True)
                ahead.append((effect, items))
    return {**state, **filled} if filled else state


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


def with_defined_words(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace of valid states, in which nothing is left to the meanings of words."""
    return DefinedWords(vocabulary, trace.told).in_trace(trace)


class DefinedWords:
    """The words that their meanings give in traces of a source, which tells ``told``."""

    def __init__(self, vocabulary: Vocabulary, told: frozenset[str] | None) -> None:
        self._told, self._names = told, words_meant(vocabulary, told)
        self._vocabulary = vocabulary
        if self._names:
            self._vocabulary = with_untold(vocabulary, untold_names(vocabulary, told))

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._names)

    def in_trace(self, trace: Trace) -> Trace:
        """The trace of valid states, with the words where it does not tell them."""
        vocabulary = self._vocabulary
        for name in self._names:
            types = vocabulary.declarations[name].parameters
            states = list(trace.states)
            for items in choices(types, trace.objects, vocabulary, f"`{name}`"):
                for place, value in _values(name, items, trace, vocabulary):
                    own = states[place]
                    states[place] = {**own, name: put(own.get(name), items, value)}
            trace = replace(trace, states=tuple(states))
        return trace

    def in_state(self, state: State, objects: Mapping[str, str]) -> State:
        """A state of a running trace, with the words.

        What they say of the past is unknown. A state that does not fit the vocabulary stays as it
        is.
        """
        try:
            alone = Trace("", 1.0, objects, (state,), ends="cut", told=self._told)
            return self.in_trace(alone).states[0]
        except (LookupError, TypeError, AttributeError, AssertionError):
            return state


def with_words_in_graph(graph: TraceGraph, vocabulary: Vocabulary) -> TraceGraph:
    """The graph of valid states, with words that their meanings give, as in a running trace."""
    words = DefinedWords(vocabulary, graph.told)
    if not words:
        return graph
    there = [present_in(x, graph.objects, graph.present) for x in range(len(graph.states))]
    layers = [
        tuple([words.in_state(state, objects) for state in own])
        for own, objects in zip(graph.states, there, strict=True)
    ]
    return replace(graph, states=tuple(layers), told=with_meant(graph.told, vocabulary))


def _values(
    name: str, items: tuple[str, ...], trace: Trace, vocabulary: Vocabulary
) -> list[tuple[int, Any]]:
    """The places of the states that do not tell a word of these objects, and its values."""
    meaning = vocabulary.meanings[name]
    binding = dict(zip(meaning.variables, items, strict=True))
    own = binding_of(binding, trace.present, len(trace.states))
    span = range(own.first, own.last + 1)
    untold = replace(vocabulary.declarations[name], default=None)
    places = [x for x in span if value_in(trace.states[x], name, items, untold) is None]
    if not places:
        return []
    objects, present = trace.objects, trace.present
    views = [StateView(trace.states[x], present_in(x, objects, present), vocabulary) for x in span]

    def proposition(asked: ltl.Proposition) -> Truth[int]:
        evaluate, sure, possible = evaluator_of(asked), 0, 0
        for place, view in enumerate(views):
            value = evaluate(binding, view)
            sure |= (value is True) << place
            possible |= (value is True or isinstance(value, Unknown)) << place
        return Truth(sure, possible)

    ends = BitInstants(len(views), "cut" if trace.ends == "cut" else "over")
    formula = _in_steps(meaning.formula, exact_step(trace.step_s))
    truth = fold(formula, ends.algebra(proposition))
    values: list[tuple[int, Any]] = []
    for place in places:
        sure, possible = (half >> place - own.first & 1 for half in (truth.sure, truth.possible))
        values.append((place, UNKNOWN if sure != possible else bool(sure)))
    return values


_in_steps = lru_cache(maxsize=256)(in_steps)
