"""Verification of single traces state by state, and what is said of one that cannot be judged."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import Diagnostic, Label, RulecError, SourceLocation
from rulec.diagnostics.diagnostic import as_answer, with_place
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.fault_containment import containing_faults
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.state_validation import check_objects, check_states, check_told
from rulec.monitoring.told_names import words_meant
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.resource_limits import BudgetSpentError
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace


@containing_faults
def verify_by_states(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """As ``verify`` in every respect, but state by state: for what arrays do not tell."""
    check_trace(trace)
    return judged_by_states(trace, rulebook_for_trace(trace, rulebook))


def judged_by_states(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """The verdict on a trace that has passed ``check_trace``, by a rulebook for its step."""
    is_partial = check_fitting(trace, rulebook)
    # A name that is unknown for all objects is unknown for each object without a value.
    trace = with_derived_values(spelled_out(trace, rulebook.vocabulary), rulebook.vocabulary)
    run = UncertainRun(trace, rulebook)
    # What is calculated may be unknown although all else is known
    is_partial = is_partial or bool(words_meant(rulebook.vocabulary, trace.told))
    if is_partial or trace.ends == "cut" or trace.told is not None:
        return run.verdict()
    check_counting_axioms(rulebook, len(trace.states), run.view, "state {}".format, trace.place)
    return Verdict(trace.id, run.verdict().violations)


def check_fitting(trace: Trace, rulebook: CompiledRulebook) -> bool:
    """Check a trace by a rulebook for its step, and say whether some of its values are unknown.

    Raises RulecError as ``verify`` does if the trace does not fit.
    """
    for rule in rulebook.rules:
        if rule.step_s is not None:
            check_step(rule, exact_step(trace.step_s), "the trace", trace.place)
    check_objects(trace.objects, rulebook.vocabulary, trace.place)
    check_told(trace.told, rulebook.vocabulary, trace.place)
    where = "state {}".format
    return check_states(trace.states, trace.objects, rulebook.vocabulary, where, trace.place)


def rulebook_for_trace(trace: Trace, rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook with the machines for a trace's step.

    Raises RulecError; errors name the trace's place.
    """
    with _errors_at(trace.place):
        return rulebook.fitted_to(trace.step_s)


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


def verify_or_reason(item: Trace | RulecError, rulebook: CompiledRulebook) -> Verdict | NotJudged:
    """Verify one trace of many, and return an error instead of raising it.

    In place of a trace, ``item`` may be the error that prevented reading one.
    """
    if isinstance(item, RulecError):
        return NotJudged(None, item)
    try:
        return verify_by_states(item, rulebook)
    except BudgetSpentError:
        raise
    except RulecError as error:
        return NotJudged(item.id, as_answer(with_place(error, item.place)))
