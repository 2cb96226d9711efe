"""The opportunities that a trace gives to violate rules, one by one, and what became of them.

An opportunity is a stretch of states, as for exposure, for one choice of objects. A trace without
any for a rule is idle: it keeps the rule without having been put to the test.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.thresholds import exact_step
from rulec.monitoring.moments.exposure import WatchedRule, watched_rules
from rulec.monitoring.moments.name_tables import tables_of
from rulec.monitoring.moments.stretches import opportunity_stretches
from rulec.monitoring.moments.trace_truth import TraceTruth
from rulec.monitoring.verdict import NotJudged, RuleFor, Verdict, rule_for
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays

Outcome = Literal["violated", "kept", "open"]


@dataclass(frozen=True, slots=True)
class Opportunity:
    """An opportunity to violate a rule, from state ``first`` to ``last`` (both included).

    ``certain`` is False if there is perhaps none. It is open if the rule may be breached in it.
    """

    rule: str
    binding: Mapping[str, str]
    first: int
    last: int
    outcome: Outcome
    certain: bool


def opportunities_of(
    trace: Trace | TraceArrays, rulebook: CompiledRulebook, verdict: Verdict | NotJudged
) -> list[Opportunity]:
    """All that a trace gives for the rules that are judged, by rule, objects and time."""
    if isinstance(verdict, NotJudged):
        return []
    truth = TraceTruth(tables_of(trace, rulebook.vocabulary), rulebook.semantics, trace.ends)
    decided: dict[RuleFor, Outcome] = {rule_for(x): "open" for x in verdict.open}
    decided |= {rule_for(x): "violated" for x in verdict.violations}
    left_out = {*[x.rule for x in verdict.not_judged], *verdict.kept_regardless}
    names = tuple(trace.objects)
    return [
        opportunity
        for watched in watched_rules(rulebook, exact_step(trace.step_s))
        if watched.rule.name not in left_out
        for opportunity in _of_rule(truth, watched, names, decided)
    ]


def _of_rule(
    truth: TraceTruth,
    watched: WatchedRule,
    names: tuple[str, ...],
    decided: Mapping[RuleFor, Outcome],
) -> Iterator[Opportunity]:
    rule, choices = watched.rule, truth.choices_of(watched.rule.variables)
    found: dict[int, list[_Stretch]] = defaultdict(list)
    for part in truth.of(watched.trigger, choices) if watched.trigger is not None else ():
        _, stretches = opportunity_stretches(part.in_trace())
        breached = [np.zeros_like(part.truth.sure) for _ in range(2)]
        rows = np.unique(stretches.rows)
        for breach in truth.of(watched.breach, part.choices.at(rows)):
            breached[0][rows[breach.rows]] = breach.truth.sure
            breached[1][rows[breach.rows]] = breach.truth.possible
        flags = [stretches.with_some(own) for own in (part.truth.sure, *breached)]
        columns = part.rows[stretches.rows], stretches.first, stretches.last, *flags
        for row, *about in zip(*[column.tolist() for column in columns], strict=True):
            found[row].append(_Stretch(*about))
    first, last = truth.stretch_of(choices)
    for row, items in enumerate(choices.items.tolist()):
        chosen = tuple([names[item] for item in items])
        verdict = decided.get((rule.name, chosen), "kept")
        if not found[row] and (watched.trigger is None or verdict != "kept"):
            is_broken = verdict == "violated"
            certain = watched.trigger is None or is_broken
            found[row].append(_Stretch(int(first[row]), int(last[row]), certain, is_broken, True))
        outcomes = [stretch.outcome(verdict) for stretch in found[row]]
        # What a verdict tells is in some opportunity, however little is known of the rule's parts
        if outcomes and verdict not in outcomes:
            outcomes[-1] = verdict
        binding = dict(zip(choices.variables, chosen, strict=True))
        for stretch, outcome in zip(found[row], outcomes, strict=True):
            first_last = stretch.first, stretch.last
            yield Opportunity(rule.name, binding, *first_last, outcome, stretch.certain)


class _Stretch(NamedTuple):
    """A stretch of states, whether its opportunity is certain, and the rule breached in it."""

    first: int
    last: int
    certain: bool
    broken: bool
    perhaps_broken: bool

    def outcome(self, verdict: Outcome) -> Outcome:
        """What became of it, by the verdict for its objects."""
        if verdict == "kept" or not self.perhaps_broken:
            return "kept"
        return "violated" if self.broken and verdict == "violated" else "open"
