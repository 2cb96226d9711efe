"""What is possible in traces: whether all that is known holds, and values that change less."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, TypeVar

from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView, value_in
from rulec.trace import State, Trace
from rulec.vocabulary import Vocabulary
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.state_synthesis import Subject, subjects_of

_Value = TypeVar("_Value")


def is_possible(trace: Trace, universe: ObjectUniverse) -> bool:
    """Whether no axiom of the universe is false in the trace, whose objects may be more."""
    # An axiom may speak of an object by its name, too.
    own = {name: name for name in trace.objects}
    everyone = replace(universe, objects=trace.objects)
    bound = [(axiom, {**own, **names}) for axiom, names in everyone.axiom_bindings()]
    views = [StateView(state, trace.objects, universe.vocabulary) for state in trace.states]
    return all(
        holds(axiom.formula, names, view) is not False for view in views for axiom, names in bound
    )


def steadied(trace: Trace, vocabulary: Vocabulary, is_right: Callable[[Trace], bool]) -> Trace:
    """The trace with fewer changes from state to state, as long as it ``is_right``.

    Each subject in turn keeps one of its values throughout, or else changes at fewer places.
    """
    names = frozenset[str]().union(*trace.states)
    for subject, declaration in subjects_of(vocabulary, trace.objects, names):
        values = [value_in(state, *subject, declaration) for state in trace.states]
        for calmer in _calmer(values):
            states = [
                said(state, subject, value)
                for state, value in zip(trace.states, calmer, strict=True)
            ]
            changed = replace(trace, states=tuple(states))
            if is_right(changed):
                trace = changed
                break
    return trace


def _calmer(values: Sequence[_Value | None]) -> Iterator[list[_Value]]:
    """Sequences of the same values that change less, calmest first."""
    known = [value for value in values if value is not None]
    if len(known) < len(values) or len(set(known)) == 1:
        return
    yield from ([value] * len(known) for value in dict.fromkeys(known))
    for place in range(1, len(known)):
        for here, there in ((place, place - 1), (place - 1, place)):
            calmer = [known[there] if at == here else value for at, value in enumerate(known)]
            if _changes(calmer) < _changes(known):
                yield calmer


def _changes(values: Sequence[object]) -> int:
    return sum(before != after for before, after in pairwise(values))


def said(state: State, subject: Subject, value: object) -> State:
    """The state with another value of a subject."""
    name, items = subject
    said: dict[str, Any] = dict(state)
    inside = said
    *outer, last = (name, *items)
    for key in outer:
        inside[key] = inside = dict(inside.get(key, {}))
    inside[last] = value
    return said
