"""Decide violability, satisfiability and implication of rules."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from math import prod

from rulec.analysis.counterexample import counterexample
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.diagnostics import RulecError
from rulec.trace import Trace
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import monitor_function
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.shortest_traces import shortest_word
from rulec.witnesses.undecided import UndecidedError

MOST_PREMISES = 6
MOST_JOINT_STATES = 5_000
"""Others are taken together as long as their automata have no more states than these."""


def can_be_violated(analyzed: AnalyzedRule) -> bool:
    """True if some trace violates the rule. Raises UndecidedError."""
    return counterexample(analyzed, []) is not None


def can_be_kept(analyzed: AnalyzedRule) -> bool:
    """True if some trace, with objects for the rule, keeps it. Raises UndecidedError."""
    objects = {variable.name: variable.type for variable in analyzed.rule.variables}
    universe = ObjectUniverse(objects, analyzed.rulebook.vocabulary, analyzed.axioms)
    bindings = universe.bindings(analyzed.rule.variables)
    machine = analyzed.rule.machine
    alphabet = JointAlphabet(universe, [monitor_function(machine, own) for own in bindings])
    machines, verdicts = [machine] * len(bindings), [True] * len(bindings)
    word = shortest_word(machines, verdicts, alphabet.candidates, alphabet.can_be_read)
    return word is not None


def implied_by(analyzed: AnalyzedRule, others: Sequence[AnalyzedRule]) -> tuple[AnalyzedRule, ...]:
    """One or few other rules that forbid all that a rule forbids, if there are any.

    The others, which are related to it, are taken together as far as their automata stay small; so
    more of them together may imply it without being found. Raises UndecidedError.
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
    """Traces that a rule forbids: most other rules allow one that was found for another of them.

    So only what allows none of those found takes a search of its own.
    """

    def __init__(self, analyzed: AnalyzedRule) -> None:
        self._analyzed = analyzed
        self._traces: list[Trace] = []
        # Who allows which of those found: rules as they are, for names are not theirs alone.
        self._allowed: dict[tuple[int, int], bool] = {}
        with suppress(UndecidedError):
            self._search([])

    def one_that_allow(self, others: Sequence[AnalyzedRule]) -> bool:
        """True if all of the others allow some trace that the rule forbids.

        Raises UndecidedError.
        """
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
                # The trace has another step, or objects to be counted that a fact rules out.
                self._allowed[key] = False
        return self._allowed[key]


def small_premises(analyzed: AnalyzedRule, related: Sequence[AnalyzedRule]) -> list[AnalyzedRule]:
    """The other rules whose automata stay small in product with the rule's."""
    types = sorted(variable.type for variable in analyzed.rule.variables)
    chosen: list[AnalyzedRule] = []
    for premise in sorted(related, key=lambda rule: len(rule.rule.machine.successors)):
        if sorted(variable.type for variable in premise.rule.variables) not in (types, []):
            continue
        sizes = [len(rule.rule.machine.successors) for rule in (analyzed, *chosen, premise)]
        if prod(sizes) <= MOST_JOINT_STATES and len(chosen) < MOST_PREMISES:
            chosen.append(premise)
    return chosen
