"""Verification of a single trace by a compiled rulebook."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Protocol, TypeAlias, TypeVar

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, check_step
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import Diagnostic, Label, RulecError, SourceLocation
from rulec.diagnostics.diagnostic import as_answer, with_place
from rulec.diagnostics.fault_messages import NOT_FAULTS, fault_of, is_fault
from rulec.logic.free_names import names_of
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.bindings import Binding, Cast, types_of
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.letter_reader import LetterReader
from rulec.monitoring.state_validation import StateValidator, check_objects, check_told
from rulec.monitoring.verdict import NotJudged, RuleNotJudged, Verdict, Violation, agreed
from rulec.resource_limits import BudgetSpentError
from rulec.trace import Trace
from rulec.trace.trace_model import check_frame, check_trace

LONG = 1 << 6
"""So many states are judged in arrays, which is faster, even if they are those of one trace."""


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
        check_frame(trace)  # a trace of wrong kinds is the caller's fault, and is said again
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


Answer: TypeAlias = Verdict | NotJudged


class _Judged(Protocol):
    @property
    def id(self) -> str: ...


Item = TypeVar("Item", bound=_Judged)
_Any = TypeVar("_Any")

Judge: TypeAlias = Callable[[Sequence[Item], Sequence[CompiledRulebook]], Sequence[Answer]]
"""Judges traces by a rulebook, rounded to their step in one way or two."""


def judged_apart(
    judge: Judge[Item], items: Sequence[Item], roundings: Sequence[CompiledRulebook]
) -> Sequence[Answer]:
    """The answers, if a fault comes by halves: it costs one rule on one trace."""
    try:
        return judge(items, roundings)
    except NOT_FAULTS:
        raise
    except Exception as problem:
        rules = roundings[0].rules
        if len(rules) <= 1 and len(items) == 1:
            fault = fault_of(problem, f"`{rules[0].name if rules else 'facts'}` in `{items[0].id}`")
            lost = [rule_lost(rule, fault) for rule in rules]
            verdict = without(Verdict(items[0].id, ()), lost, [fault])
            return [verdict if lost else NotJudged(items[0].id, fault)]
        failed = problem
    if len(rules) > 1:
        halves = [[_with_rules(book, own) for book in roundings] for own in _halves(rules)]
        parts = [judged_apart(judge, items, books) for books in halves]
        return said([_joined(*both) for both in zip(*parts, strict=True)], failed)
    apart = [x for some in _halves(items) for x in judged_apart(judge, some, roundings)]
    return said(apart, failed)


def said(answers: Sequence[Answer], problem: Exception | None) -> list[Answer]:
    """The answers; the first verdict says a fault that came where all were judged together.

    It does not if one of the answers has a fault by itself.
    """
    found = list(answers)
    verdicts = [x for x in found if isinstance(x, Verdict)]
    by_itself = any(x.faults if isinstance(x, Verdict) else is_fault(x.error) for x in found)
    if problem is not None and verdicts and not by_itself:
        fault = fault_of(problem, "judged together")
        found[found.index(verdicts[0])] = replace(verdicts[0], faults=(fault,))
    return found


def rule_lost(rule: CompiledRule, fault: RulecError) -> RuleNotJudged:
    """A rule that a fault has cost."""
    why = fault.diagnostics[0].message
    return RuleNotJudged(rule.name, rule.strength, (), why, by_fault=True)


def without_words(
    book: CompiledRulebook, faults: Mapping[str, RulecError]
) -> tuple[CompiledRulebook, list[RuleNotJudged]]:
    """The rulebook without the rules that read lost words, and these rules.

    What is known of a lost word by a fact is lost with it.
    """
    if not faults:
        return book, []
    read = {rule: faults.keys() & names_of(rule.formula) for rule in book.rules}
    lost = [rule_lost(rule, faults[min(words)]) for rule, words in read.items() if words]
    axioms = [x for x in book.axioms if faults.keys().isdisjoint(names_of(x.formula))]
    kept = tuple([rule for rule in book.rules if not read[rule]])
    return replace(book, rules=kept, axioms=tuple(axioms)), lost


def without(verdict: Verdict, lost: Sequence[RuleNotJudged], faults: list[RulecError]) -> Verdict:
    """The verdict, in which faults have cost some rules."""
    names = {rule.rule for rule in lost}
    return replace(
        verdict,
        violations=tuple([x for x in verdict.violations if x.rule not in names]),
        open=tuple([x for x in verdict.open if x.rule not in names]),
        not_judged=(*[x for x in verdict.not_judged if x.rule not in names], *lost),
        faults=tuple(dict.fromkeys((*verdict.faults, *faults))),
    )


def _halves(items: Sequence[_Any]) -> tuple[Sequence[_Any], Sequence[_Any]]:
    return items[: len(items) // 2], items[len(items) // 2 :]


def _with_rules(book: CompiledRulebook, rules: Sequence[CompiledRule]) -> CompiledRulebook:
    names = {rule.name for rule in rules}
    return replace(book, rules=tuple([rule for rule in book.rules if rule.name in names]))


def _joined(one: Answer, other: Answer) -> Answer:
    """The answer by all rules, from those by each half of them."""
    if not isinstance(one, Verdict) or not isinstance(other, Verdict):
        return other if isinstance(one, Verdict) else one
    not_judged = {rule.rule: rule for rule in (*one.not_judged, *other.not_judged)}
    return replace(
        one,
        violations=(*one.violations, *other.violations),
        open=(*one.open, *other.open),
        not_judged=tuple(not_judged.values()),
        presumed=tuple(dict.fromkeys((*one.presumed, *other.presumed))),
        faults=(*one.faults, *other.faults),
    )
