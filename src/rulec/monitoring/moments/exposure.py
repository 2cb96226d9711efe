"""Exposure: how often, and how long, a trace gives an opportunity to violate a rule.

An opportunity is one stretch of states in which a rule's trigger holds for one choice of objects;
of a rule whose form names no trigger it is the whole stretch in which the objects are there. It is
violated if the rule is breached in one of its states. See docs/rates.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import SourceLocation
from rulec.logic.bounds import in_steps
from rulec.logic.opportunities import breach_of
from rulec.logic.semantics import steps_to_settle
from rulec.monitoring.moments.stretches import Stretches, opportunity_stretches
from rulec.monitoring.moments.trace_truth import FormulaTruth, ReadyFormula, TraceTruth
from rulec.monitoring.verdict import Verdict
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays
from rulec.value_display import short_repr

Counts = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Exposure:
    """The opportunities that a trace gives to violate a rule, and those that were taken.

    ``opportunities`` are those for sure, ``perhaps_opportunities`` those at most;
    ``opportunities_s`` and ``perhaps_opportunities_s`` (s) are the states in which there is one for
    some choice of objects, each for one step. ``violated`` and ``perhaps_violated`` are the
    opportunities in which the rule is breached, for sure and at most.
    """

    __repr__ = short_repr

    opportunities: int
    perhaps_opportunities: int
    opportunities_s: float
    perhaps_opportunities_s: float
    violated: int
    perhaps_violated: int


@dataclass(frozen=True, slots=True)
class _Watched:
    """A rule with its trigger and its breach, bounds in steps."""

    rule: CompiledRule
    trigger: ReadyFormula | None
    breach: ReadyFormula


def exposures(
    trace: Trace | TraceArrays, rulebook: CompiledRulebook, verdict: Verdict
) -> dict[str, Exposure]:
    """The exposure to each rule that was judged, by its name.

    The ``verdict`` on the trace says for which objects a rule is violated or open.
    """
    outcomes: dict[str, dict[tuple[str, ...], Literal["violated", "open"]]] = {}
    for result in verdict.open:
        outcomes.setdefault(result.rule, {})[tuple(result.binding.values())] = "open"
    for violation in verdict.violations:
        outcomes.setdefault(violation.rule, {})[tuple(violation.binding.values())] = "violated"
    left_out = {rule.rule for rule in verdict.not_judged}
    truth = TraceTruth(trace, rulebook.vocabulary, rulebook.semantics)
    return {
        watched.rule.name: _exposure(
            truth, trace.step_s, watched, outcomes.get(watched.rule.name, {})
        )
        for watched in _watched(rulebook, exact_step(trace.step_s))
        if watched.rule.name not in left_out
    }


def _watched(rulebook: CompiledRulebook, step_s: Fraction) -> Sequence[_Watched]:
    known: dict[Fraction, Sequence[_Watched]] = rulebook.prepared.setdefault(_Watched, {})
    if step_s not in known:
        known[step_s] = [
            _watched_rule(rule, step_s, rulebook.place_of(rule.name)) for rule in rulebook.rules
        ]
    return known[step_s]


def _watched_rule(rule: CompiledRule, step_s: Fraction, place: SourceLocation | None) -> _Watched:
    breach = in_steps(breach_of(rule.formula), step_s, math.floor)
    if rule.trigger is None:
        return _Watched(rule, None, ReadyFormula(breach, place=place))
    trigger = in_steps(rule.trigger, step_s, math.floor)
    # Both have the same columns where the last state goes on for ever.
    settles = max(steps_to_settle(breach), steps_to_settle(trigger))
    return _Watched(
        rule, ReadyFormula(trigger, settles, place), ReadyFormula(breach, settles, place)
    )


def _exposure(
    truth: TraceTruth,
    step_s: float,
    watched: _Watched,
    outcomes: Mapping[tuple[str, ...], Literal["violated", "open"]],
) -> Exposure:
    tally = _Tally(truth.n_states)
    variables = watched.rule.variables
    found = set()
    if watched.trigger is None:
        tally.add_whole(*truth.stretches_of(variables))
    else:
        for part in truth.of(watched.trigger, variables):
            at_least, at_most = opportunity_stretches(part.sure, part.possible)
            tally.add(part, at_least, at_most)
            decided = [row for row, choice in enumerate(part.choices) if choice in outcomes]
            for row in decided:
                choice = part.choices[row]
                found.add(choice)
                own = truth.of(watched.breach, variables, choice)
                tally.violated_in(row, (at_least, at_most), next(own, None), outcomes[choice])
    for choice, outcome in outcomes.items():
        if choice not in found:
            tally.violated_at_all(outcome, is_counted=watched.trigger is None)
    return tally.exposure(step_s)


class _Tally:
    """Sums over the choices of objects of one rule."""

    def __init__(self, n_states: int) -> None:
        self._exposed = np.zeros(n_states, dtype=bool)
        self._perhaps_exposed = np.zeros(n_states, dtype=bool)
        self._opportunities = [0, 0]
        self._violated = [0, 0]

    def add_whole(self, first: Counts, last: Counts) -> None:
        """Count an opportunity for each choice of objects, as long as they are there."""
        state = np.arange(len(self._exposed))
        for begin, end in set(zip(first.tolist(), last.tolist(), strict=True)):
            self._exposed |= (state >= begin) & (state <= end)
        self._perhaps_exposed |= self._exposed
        self._opportunities = [count + len(first) for count in self._opportunities]

    def add(self, part: FormulaTruth, at_least: Stretches, at_most: Stretches) -> None:
        """Count opportunities."""
        n_states = len(self._exposed)
        self._exposed |= _on_all(part.sure, n_states)
        self._perhaps_exposed |= _on_all(part.possible, n_states)
        self._opportunities[0] += len(at_least)
        self._opportunities[1] += len(at_most)

    def violated_in(
        self,
        row: int,
        opportunities: tuple[Stretches, Stretches],
        breach: FormulaTruth | None,
        outcome: Literal["violated", "open"],
    ) -> None:
        """Count the opportunities of a row that were taken; the verdict says whether one was."""
        at_least, at_most = [stretches.of_row(row) for stretches in opportunities]
        surely = perhaps = 0
        if breach is not None:
            surely = int(at_least.with_some(breach.sure).sum())
            perhaps = int(at_most.with_some(breach.possible).sum())
        surely = 0 if outcome == "open" else max(surely, 1)
        perhaps = max(perhaps, surely, 1)
        self._violated[0] += surely
        self._violated[1] += perhaps
        # What is violated was an opportunity, however little is known of its trigger.
        self._opportunities[0] += max(surely - len(at_least), 0)
        self._opportunities[1] += max(perhaps - len(at_most), 0)

    def violated_at_all(self, outcome: Literal["violated", "open"], *, is_counted: bool) -> None:
        """Count one opportunity that was taken."""
        self._violated[0] += outcome == "violated"
        self._violated[1] += 1
        if not is_counted:
            self._opportunities[0] += outcome == "violated"
            self._opportunities[1] += 1

    def exposure(self, step_s: float) -> Exposure:
        """The sums."""
        # A stretch counts as one for sure only if it does at most.
        least, most = self._opportunities
        return Exposure(
            least,
            max(least, most),
            round(int(self._exposed.sum()) * step_s, 9),
            round(int(self._perhaps_exposed.sum()) * step_s, 9),
            *self._violated,
        )


def _on_all(flags: NDArray[np.bool_], n_states: int) -> NDArray[np.bool_]:
    """Where some row has a flag; beyond its end a row repeats what is there."""
    rows = np.atleast_1d(flags.any(axis=0))
    result = np.zeros(n_states, dtype=bool)
    size = min(n_states, len(rows))
    result[:size] = rows[:size]
    return result
