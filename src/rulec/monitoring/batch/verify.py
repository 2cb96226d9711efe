"""Verification of traces given by their states, one or many, in arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.by_states import judged_by_states, rulebook_for_trace
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_states import joined_states
from rulec.monitoring.batch.stacked.stacked_run import StackedRun
from rulec.monitoring.bindings import types_of
from rulec.monitoring.constant_values import with_constants
from rulec.monitoring.fault_containment import containing_faults
from rulec.monitoring.implied_values import with_implied_values
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.verdict import Verdict
from rulec.resource_limits import CHOICES
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace
from rulec.vocabulary.partial_values import UNKNOWN
from rulec.vocabulary.vocabulary_model import number_of_choices

IRREGULAR = UnencodableError, MissingValueError, RulecError
"""What prevents traces from being judged in arrays."""


@containing_faults
def verify(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """Verify a trace against every rule, for every binding of its variables.

    It is judged in arrays, and by its states where these do not tell. Raises RulecError R0501 to
    R0506 if it is no trace or does not fit the rulebook's vocabulary, R0507 if a rule was compiled
    for traces with another step, R0508 if a state contradicts an axiom on which a rule depends;
    errors have the trace's own place.
    """
    check_trace(trace)
    rulebook = rulebook_for_trace(trace, rulebook)
    derived = derived_trace(trace, rulebook)
    verdict = None if derived is None else verdicts_together([derived], rulebook)[0]
    return verdict or judged_by_states(trace, rulebook)


def derived_trace(trace: Trace, rulebook: CompiledRulebook) -> Trace | None:
    """A checked trace with what follows from its values; None if only its states can tell."""
    vocabulary = rulebook.vocabulary
    try:
        if not all(isinstance(text, str) for text in chain(*trace.objects.items())):
            return None  # states tell what is wrong with an object's name or type
        if not has_few_choices(trace.objects, rulebook):
            return None
        if not vocabulary.constants and not vocabulary.implied:
            return trace
        about = [x for x in vocabulary.constants if vocabulary.declarations[x].parameters]
        if any(state.get(name) is UNKNOWN for name in about for state in trace.states):
            trace = spelled_out(trace, vocabulary)
        # Words that are defined are read from the arrays
        return with_implied_values(with_constants(trace, vocabulary), vocabulary)
    except (TypeError, AttributeError, LookupError, RulecError):
        return None


def has_few_choices(objects: Mapping[str, str], rulebook: CompiledRulebook) -> bool:
    """Whether no rule has more choices of objects than the limit `choices`, which states report."""
    n_objects, most = len(objects), CHOICES.value()
    return n_objects**2 <= most or all(
        number_of_choices(types, objects, rulebook.vocabulary) <= most
        for types in dict.fromkeys(map(types_of, rulebook.rules))
        if len(types) == 2
    )


def verdicts_together(
    traces: Sequence[Trace], rulebook: CompiledRulebook
) -> Sequence[Verdict | None]:
    """The verdicts on traces of one kind, which are derived; None for irregular ones.

    These are found by halving.
    """
    try:
        return StackedRun(joined_states(traces, rulebook.vocabulary), rulebook).verdicts()
    except IRREGULAR:
        if len(traces) == 1:
            return [None]
        middle = len(traces) // 2
        halves = traces[:middle], traces[middle:]
        return [verdict for half in halves for verdict in verdicts_together(half, rulebook)]
