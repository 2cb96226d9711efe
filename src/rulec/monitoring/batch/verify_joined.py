"""Verification of traces given by their states, whatever their objects, laid end to end."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from itertools import chain

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_states import joined_states
from rulec.monitoring.batch.joined.joined_traces import TraceKind
from rulec.monitoring.batch.stacked.stacked_run import check_judgeable, judge_joined
from rulec.monitoring.bindings import types_of
from rulec.monitoring.constant_values import with_constants
from rulec.monitoring.implied_values import with_implied_values
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.verdict import Verdict
from rulec.resource_limits import CHOICES
from rulec.trace import Trace
from rulec.trace.trace_model import check_frame, check_presence
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN
from rulec.vocabulary.vocabulary_model import number_of_choices

IRREGULAR = UnencodableError, MissingValueError, RulecError
"""What prevents traces from being judged in arrays."""


def verdict_in_arrays(trace: Trace, rulebook: CompiledRulebook) -> Verdict | None:
    """The verdict on a trace by a rulebook for its step; None if its states have to tell."""
    derived = derived_trace(trace, rulebook.vocabulary)
    return None if derived is None else verdicts_together([derived], rulebook)[0]


def derived_trace(trace: Trace, vocabulary: Vocabulary) -> Trace | None:
    """The trace with what follows from its values; None if something is wrong with it."""
    about = [x for x in vocabulary.constants if vocabulary.declarations[x].parameters]
    try:
        check_frame(trace)
        check_presence(trace)
        if not all(isinstance(text, str) for text in chain(*trace.objects.items())):
            return None  # states tell what is wrong with an object's name or type
        if not vocabulary.constants and not vocabulary.implied:
            return trace
        if any(state.get(name) is UNKNOWN for name in about for state in trace.states):
            trace = spelled_out(trace, vocabulary)
        # Words that are defined are read from the arrays
        return with_implied_values(with_constants(trace, vocabulary), vocabulary)
    except (TypeError, AttributeError, LookupError, RulecError):
        return None


def verdicts_together(
    traces: Sequence[Trace], rulebook: CompiledRulebook
) -> Sequence[Verdict | None]:
    """The verdicts on traces of one kind, which are derived.

    None for those that must be judged by their states.
    """
    verdicts: list[Verdict | None] = [None] * len(traces)
    example = traces[0]
    with suppress(*IRREGULAR):
        check_judgeable(TraceKind(example.step_s, example.ends, example.told), rulebook)
        places = [n for n, trace in enumerate(traces) if _has_few_choices(trace, rulebook)]
        if places:
            _judge_together(places, traces, rulebook, verdicts)
    return verdicts


def _has_few_choices(trace: Trace, rulebook: CompiledRulebook) -> bool:
    """Whether no rule has more choices of objects than the limit `choices`, which states report."""
    n_objects, most = len(trace.objects), CHOICES.value()
    return n_objects**2 <= most or all(
        number_of_choices(types, trace.objects, rulebook.vocabulary) <= most
        for types in dict.fromkeys(map(types_of, rulebook.rules))
        if len(types) == 2
    )


def _judge_together(
    places: Sequence[int],
    traces: Sequence[Trace],
    rulebook: CompiledRulebook,
    verdicts: list[Verdict | None],
) -> None:
    """Judge some of the traces; irregular ones are left, and found by halving."""
    try:
        joined = joined_states([traces[place] for place in places], rulebook.vocabulary)
        judged = judge_joined(joined, rulebook)
    except IRREGULAR:
        middle = len(places) // 2
        for part in (places[:middle], places[middle:]) if middle else ():
            _judge_together(part, traces, rulebook, verdicts)
        return
    for place, own in zip(places, judged, strict=True):
        if own is not None:
            trace = traces[place]
            says = partial(_says, trace)
            verdicts[place] = own.findings.verdict(own.number, trace.id, says)


def _says(trace: Trace, name: str) -> bool:
    return any(name in state for state in trace.states)
