"""Decides whether rules can be violated or kept, and whether others imply them."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from math import prod

from rulec.analysis.counterexample import counterexample, forbidding_all
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.diagnostics import RulecError
from rulec.trace import Trace
from rulec.witnesses.undecided import UndecidedError

MOST_PREMISES = 6
MOST_JOINT_STATES = 5_000
"""Premises are combined as long as the product of their automata has at most this many states."""


def can_be_violated(analyzed: AnalyzedRule) -> bool:
    """Whether some trace violates the rule. Raises UndecidedError."""
    return counterexample(analyzed, []) is not None


def can_be_kept(analyzed: AnalyzedRule) -> bool:
    """Whether some trace, with objects for the rule, keeps it. Raises UndecidedError."""
    return counterexample(forbidding_all(analyzed), [analyzed]) is not None


def implied_by(analyzed: AnalyzedRule, others: Sequence[AnalyzedRule]) -> tuple[AnalyzedRule, ...]:
    """One or a few other rules that together forbid all that a rule forbids, if any.

    The others, all related to it, are combined only as far as their automata stay small, so an
    implication by more of them may be missed. Raises UndecidedError.
    """
    forbidden = ForbiddenTraces(analyzed)
    for premise in others:
        if not forbidden.one_that_allow([premise]):
            return (premise,)
    premises = small_premises(analyzed, others)
    if len(premises) < 2 or forbidden.one_that_allow(premises):
        return ()
    for premise in premises:
        fewer = [kept for kept in premises if kept is not premise]
        if not forbidden.one_that_allow(fewer):
            premises = fewer
    return tuple(premises)


class ForbiddenTraces:
    """Traces that a rule forbids; most other rules allow a trace found for one of them.

    So only rules that allow none of the found traces need a search of their own.
    """

    def __init__(self, analyzed: AnalyzedRule) -> None:
        self._analyzed = analyzed
        self._traces: list[Trace] = []
        # Whether a rule allows a trace; keyed by rule object, since names are not unique.
        self._allowed: dict[tuple[int, int], bool] = {}
        with suppress(UndecidedError):
            self._search([])

    def one_that_allow(self, others: Sequence[AnalyzedRule]) -> bool:
        """Whether all others allow some trace that the rule forbids. Raises UndecidedError."""
        numbers = range(len(self._traces))
        if any(all(self._allows(other, number) for other in others) for number in numbers):
            return True
        return self._search(others)

    def _search(self, others: Sequence[AnalyzedRule]) -> bool:
        trace = counterexample(self._analyzed, others)
        if trace is not None:
            self._traces.append(trace)
        return trace is not None

    def _allows(self, other: AnalyzedRule, number: int) -> bool:
        key = id(other), number
        if key not in self._allowed:
            vocabulary = self._analyzed.rulebook.vocabulary
            try:
                self._allowed[key] = not other.violations(self._traces[number], vocabulary)
            except RulecError:
                # The trace has another step, or has objects that a fact with a count excludes.
                self._allowed[key] = False
        return self._allowed[key]


def small_premises(analyzed: AnalyzedRule, related: Sequence[AnalyzedRule]) -> list[AnalyzedRule]:
    """The other rules whose automata have a small product with the rule's."""
    types = sorted(variable.type for variable in analyzed.rule.variables)
    chosen: list[AnalyzedRule] = []
    for premise in sorted(related, key=lambda rule: len(rule.rule.machine.successors)):
        if sorted(variable.type for variable in premise.rule.variables) not in (types, []):
            continue
        sizes = [len(rule.rule.machine.successors) for rule in (analyzed, *chosen, premise)]
        if prod(sizes) <= MOST_JOINT_STATES and len(chosen) < MOST_PREMISES:
            chosen.append(premise)
    return chosen
