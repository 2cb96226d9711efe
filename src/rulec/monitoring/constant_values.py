"""Constants of a trace: a value in one state holds in all states."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from rulec.diagnostics import RulecError, SourceLocation
from rulec.monitoring.monitoring_messages import UNFITTING_VALUE
from rulec.monitoring.state_view import put
from rulec.trace import State, Trace
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval

Subject: TypeAlias = tuple[str, ...]
"""The objects that a value is about; none for the world."""

_Stated: TypeAlias = dict[Subject, tuple[Any, int]]
"""The known values of a name by subject, each with the first state that contains it."""


def with_constants(
    trace: Trace, vocabulary: Vocabulary, where: Callable[[int], str] = "state {}".format
) -> Trace:
    """A trace of valid states, with every constant's value filled in in all states.

    The value is the one that some state contains, else the interval that remains, else unknown. A
    constant that no state mentions has its default. Raises RulecError R0503 for two values.
    """
    states = trace.states
    for name in vocabulary.constants:
        first = states[0].get(name)
        # Usually all states agree, or have no value.
        if any(state.get(name) != first for state in states):
            depth = len(vocabulary.declarations[name].parameters)
            values = _stated_values(name, depth, states, where, trace.place)
            states = tuple(_filled(states, name, values, trace.present))
    return trace if states is trace.states else replace(trace, states=states)


def _stated_values(
    name: str,
    depth: int,
    states: Sequence[State],
    where: Callable[[int], str],
    place: SourceLocation | None,
) -> _Stated:
    stated: _Stated = {}
    before: object = None
    for number, state in enumerate(states):
        given = state.get(name)
        if given == before:
            continue
        before = given
        for subject, value in values_in(given, depth):
            known = stated.get(subject)
            merged = value if known is None else agreed_value(known[0], value)
            if merged is None and known is not None:
                earlier = f"{where(known[1])} says {display(known[0])}"
                raise changed(
                    name, subject, f"{where(number)} says {display(value)}, {earlier}", place
                )
            if known is None or merged != known[0]:
                stated[subject] = merged, number
    return stated


def values_in(given: Any, depth: int) -> Iterator[tuple[Subject, Any]]:
    """The values of a name in a state, with the objects that each is about."""
    if depth and isinstance(given, Mapping):
        for item, inner in given.items():
            for items, value in values_in(inner, depth - 1):
                yield (item, *items), value
    elif not depth and given is not None:
        yield (), given


def changed(
    name: str,
    subject: Subject,
    message: str,
    place: SourceLocation | None,
    way_out: str = "say one value, or leave out the others",
) -> RulecError:
    """The error (R0503) that a constant has two values in one trace."""
    about = f" of {', '.join(f'`{item}`' for item in subject)}" if subject else ""
    return UNFITTING_VALUE.error(
        place,
        f"`{name}`{about} cannot change in a trace: {message}",
        help=f"the vocabulary says `constant {name}`; {way_out}",
    )


def display(value: object) -> str:
    """A value as messages show it."""
    if isinstance(value, Interval):
        return f"{value.low:g} to {value.high:g}"
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


def agreed_value(first: Any, second: Any) -> Any:
    """What two values of a constant imply together; None if they contradict each other."""
    if first is UNKNOWN or second is UNKNOWN:
        return second if first is UNKNOWN else first
    bounds = [(x.low, x.high) if isinstance(x, Interval) else (x, x) for x in (first, second)]
    if not any(isinstance(x, Interval) for x in (first, second)):
        return first if first == second else None
    low, high = max(x[0] for x in bounds), min(x[1] for x in bounds)
    return None if low > high else low if low == high else Interval(low, high)


def _filled(
    states: Sequence[State], name: str, stated: _Stated, present: Mapping[str, tuple[int, int]]
) -> Iterator[State]:
    whole, stretches = (0, len(states) - 1), []
    for subject, (value, _) in stated.items():
        spans = [whole, *[present.get(item, whole) for item in subject]]
        begins, ends = max(x for x, _ in spans), min(x for _, x in spans)
        stretches.append((begins, ends, subject, value))
    for number, state in enumerate(states):
        given: Any = state.get(name)
        filled: Any = dict(given) if isinstance(given, Mapping) else given
        for begins, ends, subject, value in stretches:
            if begins <= number <= ends:
                if len(subject) == 1 and type(filled) is dict:
                    filled[subject[0]] = value
                else:
                    filled = put(filled, subject, value)
        yield state if filled == given else {**state, name: filled}
