"""Values that stand for all that unknown constants may have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.monitoring.bindings import Binding
from rulec.monitoring.uncertainty.completions import Subject
from rulec.monitoring.uncertainty.possible_letters import PossibleLetters
from rulec.monitoring.uncertainty.supposed_constants import ConstantsReader
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue


class Suppositions:
    """What may be supposed of the constants of a trace.

    ``vocabulary`` has the defaults of what its states do not say.
    """

    def __init__(self, trace: Trace, rulebook: CompiledRulebook, vocabulary: Vocabulary) -> None:
        self._trace = trace
        self._reader = ConstantsReader(rulebook, vocabulary, trace.objects)
        self._letters = PossibleLetters(trace, rulebook, vocabulary)

    def of(self, rule: CompiledRule, binding: Binding) -> tuple[list[dict[Subject, Value]], bool]:
        """The values that unknown constants which a rule or a fact reads may have, together."""
        subjects = self._reader.read_by(rule, binding.objects)
        return self._reader.suppositions(rule, {x: self._constant(x) for x in subjects})

    def _constant(self, subject: Subject) -> PartialValue | None:
        """What the states in which its objects are there, all alike, say of a constant."""
        first = max((self._trace.present.get(x, (0, 0))[0] for x in subject[1]), default=0)
        return self._letters.values(*subject)[first]


def spelled_out(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace in which a name that is unknown itself is unknown of each object."""
    wanted = {
        name: item.parameters for name, item in vocabulary.declarations.items() if item.parameters
    }

    def each(value: Any, kinds: Sequence[str]) -> Any:
        if not kinds or (value is not UNKNOWN and not isinstance(value, Mapping)):
            return value
        given: Any = value
        if value is UNKNOWN:
            own = trace.objects.items()
            given = {item: UNKNOWN for item, kind in own if vocabulary.is_subtype(kind, kinds[0])}
        return {item: each(inner, kinds[1:]) for item, inner in given.items()}

    if not any(
        name in wanted
        and (value is UNKNOWN or (len(wanted[name]) > 1 and UNKNOWN in cast("Any", value).values()))
        for state in trace.states
        for name, value in state.items()
    ):
        return trace
    states = [
        {name: each(value, wanted.get(name, ())) for name, value in state.items()}
        for state in trace.states
    ]
    return replace(trace, states=tuple(states))


def with_supposed(trace: Trace, values: Mapping[Subject, Value]) -> Trace:
    """The trace in each of whose states these are the values."""
    return replace(trace, states=tuple(_supposed(trace.states, values))) if values else trace


def _supposed(states: Sequence[State], values: Mapping[Subject, Value]) -> Iterator[State]:
    for state in states:
        changed: dict[str, Any] = dict(state)
        for (name, items), value in values.items():
            if not items:
                changed[name] = value
            else:
                changed[name] = _nested(changed.get(name) or {}, items, value)
        yield changed


def _nested(given: Mapping[str, Any], items: tuple[str, ...], value: Value) -> Mapping[str, Any]:
    first, *others = items
    inner = _nested(given.get(first) or {}, tuple(others), value) if others else value
    return {**given, first: inner}
