"""What is possible in traces: whether all that is known holds, and values that change less."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from dataclasses import replace
from itertools import accumulate, pairwise
from typing import Any, TypeVar

from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView, value_in
from rulec.trace import State, Trace
from rulec.vocabulary import Quantity, Vocabulary
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.state_synthesis import Subject, subjects_of

_Value = TypeVar("_Value")

APPROACHED = frozenset(
    ("distance_to_crossing", "distance_to_junction", "distance_to_stop_line", "time_to_stop_line")
)
"""What comes nearer as ego drives on, among the words of `road`."""

USUAL_KMH = (25.0, 50.0, 75.0)


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
        trace = _first_right(trace, subject, _calmer(values), is_right)
    return trace


def approaching(
    trace: Trace, vocabulary: Vocabulary, names: Set[str], is_right: Callable[[Trace], bool]
) -> Trace:
    """The trace with what is ahead coming nearer as ego drives, as long as it ``is_right``.

    Only these names are looked at. Without ego's speed it has a usual one throughout.
    """

    def numbers_of(name: str) -> list[float]:
        item = vocabulary.declarations[name]
        values = [value_in(state, name, (), item) for state in trace.states]
        return [value for value in values if isinstance(value, int | float)]

    usual = [[kmh] * len(trace.states) for kmh in USUAL_KMH]
    driven = [numbers_of("speed")] if "speed" in names else usual
    for name in sorted(APPROACHED & names):
        item, numbers = vocabulary.declarations[name], numbers_of(name)
        # By default it is far away, or nowhere.
        if len(numbers) == len(trace.states) and ({*numbers} != {item.default} or not item.default):
            in_metres = isinstance(item, Quantity) and item.unit == "m"
            ways = [
                [trace.step_s * (round(kmh / 3.6) if in_metres else 1) for kmh in speeds]
                for speeds in driven
            ]
            nearer = (
                [value if value >= 0 else item.default for value in _along(numbers, way, place)]
                for way in ways
                for place in reversed(range(len(numbers)))
            )
            trace = _first_right(trace, (name, ()), nearer, is_right)
    return trace


def _along(numbers: Sequence[float], by: Sequence[float], place: int) -> list[float]:
    """Numbers that fall by so much from one to the next, the same as before at one place."""
    passed = [0.0, *accumulate(by)]
    return [round(numbers[place] + passed[place] - passed[at], 3) for at in range(len(numbers))]


def _first_right(
    trace: Trace,
    subject: Subject,
    sequences: Iterable[Sequence[object]],
    is_right: Callable[[Trace], bool],
) -> Trace:
    """The trace with the first of these sequences of values that ``is_right``, or as it is."""
    for values in sequences:
        pairs = zip(trace.states, values, strict=True)
        changed = replace(
            trace, states=tuple(said(state, subject, value) for state, value in pairs)
        )
        if is_right(changed):
            return changed
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
