"""Values that represent everything that unknown constants may be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.monitoring.bindings import Binding
from rulec.monitoring.uncertainty.state_letters.possible_letters import PossibleLetters
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.monitoring.uncertainty.supposed_constants import ConstantsReader
from rulec.trace import Trace, Value
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue, UnknownValue


class Suppositions:
    """The values that may be supposed for the constants of a trace.

    ``vocabulary`` has the defaults of values missing in its states, ``letters`` read them.
    """

    def __init__(
        self,
        trace: Trace,
        rulebook: CompiledRulebook,
        vocabulary: Vocabulary,
        letters: PossibleLetters,
    ) -> None:
        self._trace = trace
        self._reader = ConstantsReader(rulebook, vocabulary, trace.objects)
        self._letters = letters

    def of(self, rule: CompiledRule, binding: Binding) -> tuple[list[dict[Subject, Value]], bool]:
        """The joint values that unknown constants read by a rule or an axiom may have."""
        subjects = self._reader.read_by(rule, binding.objects)
        if not subjects:
            return [{}], True
        return self._reader.suppositions(rule, {x: self._constant(x) for x in subjects})

    def _constant(self, subject: Subject) -> PartialValue | None:
        """The value of a constant, which is the same in all states with its objects."""
        first = max((self._trace.present.get(x, (0, 0))[0] for x in subject[1]), default=0)
        return self._letters.values(*subject)[first]


def spelled_out(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace in which a name that is unknown as a whole is unknown for each object."""
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

    nested = [name for name, kinds in wanted.items() if len(kinds) > 1]

    def is_short(state: Any) -> bool:
        if UnknownValue in map(type, state.values()) and any(
            state.get(name) is UNKNOWN for name in wanted
        ):
            return True
        return any(name in state and UNKNOWN in state[name].values() for name in nested)

    if not any(map(is_short, trace.states)):
        return trace
    states = [
        {name: each(value, wanted.get(name, ())) for name, value in state.items()}
        for state in trace.states
    ]
    return replace(trace, states=tuple(states))
