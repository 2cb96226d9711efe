"""What a fault of rulec costs: one rule, on the traces on which it happens."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from typing import Protocol, TypeAlias, TypeVar

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import NOT_FAULTS, fault_of, is_fault
from rulec.logic.free_names import names_of
from rulec.monitoring.told_names import names_behind, words_meant
from rulec.monitoring.verdict import NotJudged, RuleNotJudged, Verdict
from rulec.trace import Trace
from rulec.trace.trace_model import check_frame

Answer: TypeAlias = Verdict | NotJudged


class _Judged(Protocol):
    @property
    def id(self) -> str: ...


Item = TypeVar("Item", bound=_Judged)
_Any = TypeVar("_Any")

Judge: TypeAlias = Callable[[Sequence[Item], CompiledRulebook], Sequence[Answer]]
"""Judges traces by a rulebook for their step."""


def judged_apart(
    judge: Judge[Item], items: Sequence[Item], rulebook: CompiledRulebook
) -> Sequence[Answer]:
    """The answers, if a fault comes by halves: it costs one rule on one trace."""
    try:
        return judge(items, rulebook)
    except NOT_FAULTS:
        raise
    except Exception as problem:
        rules = rulebook.rules
        if len(rules) <= 1 and len(items) == 1:
            fault = fault_of(problem, f"`{rules[0].name if rules else 'facts'}` in `{items[0].id}`")
            lost = [rule_lost(rule, fault) for rule in rules]
            verdict = without(Verdict(items[0].id, ()), lost, [fault])
            return [verdict if lost else NotJudged(items[0].id, fault)]
        failed = problem
    if len(rules) > 1:
        halves = [replace(rulebook, rules=tuple(own)) for own in _halves(rules)]
        parts = [judged_apart(judge, items, half) for half in halves]
        return said([_joined(*both) for both in zip(*parts, strict=True)], failed)
    apart = [x for some in _halves(items) for x in judged_apart(judge, some, rulebook)]
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
    book: CompiledRulebook, faults: Mapping[str, RulecError], told: frozenset[str] | None
) -> tuple[CompiledRulebook, list[RuleNotJudged]]:
    """The rulebook without the rules that read lost words, and these rules.

    What is known of a lost word by a fact is lost with it, and so are words that the source does
    not tell but that are defined by it.
    """
    if not faults:
        return book, []
    vocabulary = book.vocabulary
    meant = words_meant(vocabulary, None if told is None else told | faults.keys())
    read = {
        rule: faults.keys() & names_behind(names_of(rule.formula), vocabulary, meant)
        for rule in book.rules
    }
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
        kept_regardless=tuple([x for x in verdict.kept_regardless if x not in names]),
        faults=tuple(dict.fromkeys((*verdict.faults, *faults))),
    )


def _halves(items: Sequence[_Any]) -> tuple[Sequence[_Any], Sequence[_Any]]:
    return items[: len(items) // 2], items[len(items) // 2 :]


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
        kept_regardless=(*one.kept_regardless, *other.kept_regardless),
        faults=(*one.faults, *other.faults),
    )


TraceJudge = Callable[[Trace, CompiledRulebook], Verdict]
"""Judges a trace by a rulebook, in arrays or by its states."""


def containing_faults(judge: TraceJudge) -> TraceJudge:
    """The judge; a fault of rulec in it costs only the rules that it is in."""

    @wraps(judge)
    def contained(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
        try:
            return judge(trace, rulebook)
        except Exception as problem:
            if isinstance(problem, RulecError) or not isinstance(trace, Trace):
                raise
            check_frame(trace)  # a trace of wrong kinds is the caller's fault, and is said again
            (answer,) = judged_apart(
                lambda traces, rules: [judge(one, rules) for one in traces],
                [trace],
                rulebook.fitted_to(trace.step_s),
            )
        if isinstance(answer, NotJudged):
            raise answer.error
        return answer

    return contained
