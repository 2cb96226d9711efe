"""Exposure: how often, and for how long, a trace gives an opportunity to violate a rule.

An opportunity is a stretch of states in which a rule's trigger holds for one choice of objects; for
a rule whose form has no trigger it is the whole stretch in which the objects are present. It counts
as violated if the rule is breached in one of its states. See docs/rates.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.thresholds import exact_step
from rulec.logic.bounds import in_steps
from rulec.logic.opportunities import breach_of
from rulec.logic.semantics import steps_to_settle
from rulec.monitoring.moments.stretches import (
    Stretches,
    most_violated,
    opportunity_stretches,
)
from rulec.monitoring.moments.trace_truth import (
    ChosenObjects,
    FormulaTruth,
    ReadyFormula,
    TraceTruth,
)
from rulec.monitoring.verdict import OpenVerdict, Verdict, Violation
from rulec.resource_limits import LOOKBACK
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class Exposure:
    """The opportunities that a trace gives to violate a rule, and how many were violated.

    ``opportunities`` are certain ones, ``perhaps_opportunities`` the most that there may be;
    ``opportunities_s`` and ``perhaps_opportunities_s`` (s) are the durations of the states with an
    opportunity for some choice of objects. ``violated`` and ``perhaps_violated`` are the
    opportunities in which the rule is breached, for certain and at most.
    """

    __repr__ = short_repr

    opportunities: int
    perhaps_opportunities: int
    opportunities_s: float
    perhaps_opportunities_s: float
    violated: int
    perhaps_violated: int


@dataclass(frozen=True, slots=True)
class WatchedRule:
    """A rule with its trigger, if it has one, and its breach, with bounds in steps."""

    rule: CompiledRule
    trigger: ReadyFormula | None
    breach: ReadyFormula


Outcome = Literal["violated", "open"]

Chosen = tuple[int, tuple[int, ...]]
"""A trace, and objects of it, numbered as in tables."""


def alike_exposures(
    truth: TraceTruth,
    step_s: float,
    rulebook: CompiledRulebook,
    verdicts: Sequence[Verdict],
    names: Sequence[tuple[str, ...]],
) -> list[dict[str, Exposure]]:
    """The exposures of traces of one shape; ``names`` are the object names of each."""
    outcomes: dict[str, dict[Chosen, Outcome]] = {}
    for number, (verdict, own) in enumerate(zip(verdicts, names, strict=True)):
        decided: list[OpenVerdict | Violation] = [*verdict.open, *verdict.violations]
        item_of = {
            item: place for place, item in enumerate(own if decided else (), number * len(own))
        }
        for finding in decided:
            items = tuple([item_of[item] for item in finding.binding.values()])
            outcome: Outcome = "violated" if isinstance(finding, Violation) else "open"
            outcomes.setdefault(finding.rule, {})[number, items] = outcome
    # Of a rule that no trace can be known to violate, those that keep it tell no rate
    left_out = [
        {*[rule.rule for rule in verdict.not_judged], *verdict.kept_regardless}
        for verdict in verdicts
    ]
    result: list[dict[str, Exposure]] = [{} for _ in verdicts]
    for watched in watched_rules(rulebook, exact_step(step_s)):
        rule = watched.rule
        if all(rule.name in those for those in left_out):
            continue
        tally = _tally(truth, watched, outcomes.get(rule.name, {}))
        for of_trace, those, exposure in zip(
            result, left_out, tally.exposures(step_s), strict=True
        ):
            if rule.name not in those:
                of_trace[rule.name] = exposure
    return result


def watched_rules(rulebook: CompiledRulebook, step_s: Fraction) -> Sequence[WatchedRule]:
    """All rules of a rulebook, for traces with this step (s)."""
    known: dict[Fraction, Sequence[WatchedRule]] = rulebook.prepared.setdefault(WatchedRule, {})
    if step_s not in known:
        known[step_s] = [_watched_rule(rule, step_s, rulebook) for rule in rulebook.rules]
    return known[step_s]


def _watched_rule(rule: CompiledRule, step_s: Fraction, rulebook: CompiledRulebook) -> WatchedRule:
    breach = in_steps(breach_of(rule.formula), step_s)
    trigger = None if rule.trigger is None else in_steps(rule.trigger, step_s)
    # Both have the same columns if the last state is repeated for ever.
    settles = steps_to_settle(breach)
    settles = settles if trigger is None else max(settles, steps_to_settle(trigger))
    if settles > LOOKBACK.value():
        # The rulebook's source is read again for a place
        LOOKBACK.within(settles, rulebook.place_of(rule.name), "the formula")
    ready = None if trigger is None else ReadyFormula(trigger, settles)
    return WatchedRule(rule, ready, ReadyFormula(breach, settles))


def _tally(truth: TraceTruth, watched: WatchedRule, outcomes: Mapping[Chosen, Outcome]) -> _Tally:
    tally = _Tally(truth.tables.last)
    choices = truth.choices_of(watched.rule.variables)
    left = dict(outcomes)
    if watched.trigger is None:
        tally.add_whole(choices.trace, *truth.stretch_of(choices))
    else:
        for part in truth.of(watched.trigger, choices):
            opportunities = opportunity_stretches(part.truth)
            tally.add(part, opportunities)
            rows, decided = _decided(part.choices, left)
            if decided:
                own = part.choices.at(rows)
                taken = [stretches.of_rows(rows) for stretches in opportunities]
                breached = np.zeros((2, len(rows)), dtype=np.intp)
                for breach in truth.of(watched.breach, own):
                    at = rows[breach.rows]
                    surely = taken[0].of_rows(breach.rows)
                    own_trigger = Truth(part.truth.sure[at], part.truth.possible[at])
                    breached[:, breach.rows] += (
                        surely.per_row(len(at), surely.with_some(breach.truth.sure)),
                        most_violated(own_trigger, breach.truth.possible),
                    )
                is_open = np.array([outcome == "open" for outcome in decided])
                tally.violated_in(own.trace, taken, breached, is_open)
    for (trace, _), outcome in left.items():
        tally.violated_at_all(trace, outcome, is_counted=watched.trigger is None)
    return tally


def _decided(choices: ChosenObjects, left: dict[Chosen, Outcome]) -> tuple[Indices, list[Outcome]]:
    """The rows that are violated or open, with their outcomes, which are removed from ``left``."""
    if not left:
        return np.zeros(0, dtype=np.intp), []
    near = np.flatnonzero(np.isin(choices.trace, [trace for trace, _ in left]))
    those = choices.at(near)
    rows, decided = [], []
    for row, trace, items in zip(
        near.tolist(), those.trace.tolist(), those.items.tolist(), strict=True
    ):
        outcome = left.pop((trace, tuple(items)), None)
        if outcome is not None:
            rows.append(row)
            decided.append(outcome)
    return np.array(rows, dtype=np.intp), decided


class _Tally:
    """Sums over the choices of objects of one rule, for each trace."""

    def __init__(self, last: Indices) -> None:
        n_traces, n_states = len(last), int(last.max()) + 1
        self._there = np.arange(n_states) <= last[:, None]
        self._exposed = np.zeros((2, n_traces, n_states), dtype=bool)
        self._opportunities = np.zeros((2, n_traces), dtype=np.intp)
        self._violated = np.zeros((2, n_traces), dtype=np.intp)

    def add_whole(self, trace: Indices, first: Indices, last: Indices) -> None:
        """Count one opportunity for each choice of objects, for as long as they are present."""
        n_traces, n_states = self._there.shape
        edges = np.zeros((n_traces, n_states + 1), dtype=np.intp)
        np.add.at(edges, (trace, first), 1)
        np.add.at(edges, (trace, last + 1), -1)
        self._exposed |= np.cumsum(edges, axis=1)[:, :-1] > 0
        self._opportunities += np.bincount(trace, minlength=n_traces)

    def add(self, part: FormulaTruth, opportunities: Sequence[Stretches]) -> None:
        """Count opportunities."""
        n_traces, n_states = self._there.shape
        traces, begins = np.unique(part.choices.trace, return_index=True)
        size = min(n_states, part.truth.sure.shape[1])
        exposed_at = part.in_trace()
        for level, flags in enumerate((exposed_at.sure, exposed_at.possible)):
            exposed = np.logical_or.reduceat(flags[:, :size], begins, axis=0)
            self._exposed[level, traces, :size] |= exposed
            own = part.choices.trace[opportunities[level].rows]
            self._opportunities[level] += np.bincount(own, minlength=n_traces)

    def violated_in(
        self,
        trace: Indices,
        opportunities: Sequence[Stretches],
        breached: Indices,
        is_open: Flags,
    ) -> None:
        """Count the violated opportunities of rows; the verdict says whether there is one."""
        surely = np.where(is_open, 0, np.maximum(breached[0], 1))
        perhaps = np.maximum(np.maximum(breached[1], surely), 1)
        for level, taken in enumerate((surely, perhaps)):
            np.add.at(self._violated[level], trace, taken)
            # A violation implies an opportunity, however little is known of the trigger.
            lacks = np.maximum(taken - opportunities[level].per_row(len(trace)), 0)
            np.add.at(self._opportunities[level], trace, lacks)

    def violated_at_all(self, trace: int, outcome: Outcome, *, is_counted: bool) -> None:
        """Count one violated opportunity."""
        taken = np.array([outcome == "violated", True], dtype=np.intp)
        self._violated[:, trace] += taken
        if not is_counted:
            self._opportunities[:, trace] += taken

    def exposures(self, step_s: float) -> Iterator[Exposure]:
        """The sums of each trace."""
        least, most = self._opportunities
        states = (self._exposed & self._there).sum(axis=2)
        # A certain opportunity must also be among the possible ones.
        counts = np.stack([least, np.maximum(least, most), *states, *self._violated], axis=1)
        for fewest, highest, sure, perhaps, *violated in counts.tolist():
            seconds = round(sure * step_s, 9), round(perhaps * step_s, 9)
            yield Exposure(fewest, highest, *seconds, *violated)
