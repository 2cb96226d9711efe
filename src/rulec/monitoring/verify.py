"""Verification of a single trace by a compiled rulebook."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, check_step
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import Diagnostic, Label, RulecError, SourceLocation
from rulec.diagnostics.diagnostic import as_answer, with_place
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.bindings import Binding, Cast, types_of
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.letter_reader import LetterReader
from rulec.monitoring.state_validation import StateValidator, check_objects, check_told
from rulec.monitoring.verdict import NotJudged, Verdict, Violation, agreed
from rulec.resource_limits import BudgetSpentError
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace


def verify(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """Verify a trace against every rule, for every binding of its variables.

    Raises RulecError R0501 to R0506 if it is no trace or does not fit the rulebook's vocabulary,
    R0507 if a rule was compiled for traces with another step, R0508 if a state contradicts an axiom
    on which a rule depends; errors have the trace's own place.
    """
    check_trace(trace)
    with _errors_at(trace.place):
        roundings = rulebook.rounded_to(trace.step_s)
    if len(roundings) > 1:
        return agreed([verify(trace, rounded) for rounded in roundings])
    rulebook, is_partial = rulebook_for_checked(trace, rulebook)
    if is_partial or trace.ends == "cut" or trace.told is not None:
        # Loads NumPy, 100 ms: only if values are unknown.
        from rulec.monitoring.uncertainty.suppositions import spelled_out
        from rulec.monitoring.uncertainty.uncertain_verdict import uncertain_verdict

        # A name that is unknown for all objects is unknown for each object without a value.
        trace = with_derived_values(spelled_out(trace, rulebook.vocabulary), rulebook.vocabulary)
        return uncertain_verdict(trace, rulebook)
    reader = letter_reader_of(trace, rulebook)
    check_counting_axioms(rulebook, len(trace.states), reader.view, "state {}".format, trace.place)
    violations = []
    for rule in rulebook.rules:
        # Bindings with equal words share a run.
        verdicts: dict[tuple[int, ...], tuple[bool, int | None]] = {}
        for binding in _bindings(rule, trace, reader):
            word = reader.word(rule, binding.objects, binding.first, binding.last)
            if word not in verdicts:
                verdicts[word] = run(rule.machine, word)
            accepted, step = verdicts[word]
            if not accepted:
                step = None if step is None else binding.first + step
                violations.append(Violation(rule.name, rule.strength, binding.objects, step))
    return Verdict(trace.id, tuple(violations))


def rulebook_for_checked(trace: Trace, rulebook: CompiledRulebook) -> tuple[CompiledRulebook, bool]:
    """The rulebook for a trace's step, and whether some of its values are unknown.

    Raises RulecError as ``verify`` does if the trace does not fit.
    """
    rulebook = rulebook_for_trace(trace, rulebook)
    for rule in rulebook.rules:
        if rule.step_s is not None:
            check_step(rule, exact_step(trace.step_s), "the trace", trace.place)
    check_objects(trace.objects, rulebook.vocabulary, trace.place)
    check_told(trace.told, rulebook.vocabulary, trace.place)
    validator = StateValidator(rulebook.vocabulary, trace.objects)
    return rulebook, validator.check(trace.states, "state {}".format, trace.place)


def _bindings(rule: CompiledRule, trace: Trace, reader: LetterReader) -> Iterator[Binding]:
    """A rule's bindings; if there are many, only those that may not be kept."""
    vocabulary = reader.rulebook.vocabulary
    cast = Cast(trace.objects, vocabulary, len(trace.states), trace.present, trace.place)
    if not cast.has_many(types_of(rule)):
        return cast.bindings(rule)
    # Loads NumPy, 100 ms: only if there are many bindings.
    from rulec.monitoring.uncertainty.lazy_bindings import doubtful_bindings, known_bits
    from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine

    idle = uncertain_machine(rule, None).idle
    return doubtful_bindings(rule, cast, known_bits(reader, rule), idle)


def letter_reader_of(
    trace: Trace, rulebook: CompiledRulebook, where: Callable[[int], str] = "state {}".format
) -> LetterReader:
    """The letter reader of a checked trace; ``where`` names states in messages.

    Raises RulecError R0503 if a constant changes.
    """
    trace = with_derived_values(trace, rulebook.vocabulary, where)
    place, objects, present = trace.place, trace.objects, trace.present
    return LetterReader(
        trace.states, rulebook, where, place=place, objects=objects, present=present
    )


def rulebook_for_trace(trace: Trace, rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook with the machines for a trace's step. Raises RulecError."""
    return rulebook_for_step(trace.step_s, rulebook, trace.place)


def rulebook_for_step(
    step_s: float, rulebook: CompiledRulebook, place: SourceLocation | None = None
) -> CompiledRulebook:
    """The rulebook compiled for a trace's step (s); errors name the trace's place."""
    with _errors_at(place):
        return rulebook.fitted_to(step_s)


@contextmanager
def _errors_at(place: SourceLocation | None) -> Iterator[None]:
    try:
        yield
    except RulecError as error:
        # The error is about this trace, so the place of the rule is only a note.
        raise type(error)([_at(place, diagnostic) for diagnostic in error.diagnostics]) from None


def _at(place: SourceLocation | None, problem: Diagnostic) -> Diagnostic:
    if place is None:
        return problem
    here = () if problem.place is None else (Label(problem.place, "asked for here"),)
    return replace(problem, place=place, labels=(*here, *problem.labels))


def verify_contained(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """``verify``; a fault of rulec costs only the rules that it is in."""
    try:
        return verify(trace, rulebook)
    except Exception as problem:
        if isinstance(problem, RulecError) or not isinstance(trace, Trace):
            raise
        # Judging apart, 1 ms: only after a fault.
        from rulec.monitoring.faulty_rules import judged_apart

        (answer,) = judged_apart(_verified, [trace], rulebook.rounded_to(trace.step_s))
    if isinstance(answer, NotJudged):
        raise answer.error
    return answer


def _verified(traces: Sequence[Trace], roundings: Sequence[CompiledRulebook]) -> list[Verdict]:
    return [agreed([verify(trace, rounded) for rounded in roundings]) for trace in traces]


def verify_or_reason(item: Trace | RulecError, rulebook: CompiledRulebook) -> Verdict | NotJudged:
    """Verify one trace of many, and return an error instead of raising it.

    In place of a trace, ``item`` may be the error that prevented reading one.
    """
    if isinstance(item, RulecError):
        return NotJudged(None, item)
    try:
        return verify_contained(item, rulebook)
    except BudgetSpentError:
        raise
    except RulecError as error:
        return NotJudged(item.id, as_answer(with_place(error, item.place)))


def run(machine: MealyMonitor, word: Sequence[int], start: int = 0) -> tuple[bool, int | None]:
    """Run a machine on a non-empty word of letter classes from ``start``.

    Returns whether it accepts, and the index of the letter at which the word is lost, whether it
    continues or ends there; None if it is not lost. From a rejecting sink it is lost at the first
    letter.
    """
    successors, rejecting_sink = machine.successors, machine.rejecting_sink
    state = before = start
    for index, symbol in enumerate(word):
        before, state = state, successors[state][symbol]
        # A word that ends here may be accepted although no longer word is: `weak next false`.
        if state == rejecting_sink and not machine.outputs[before][symbol]:
            return False, index
    return machine.outputs[before][word[-1]], None
