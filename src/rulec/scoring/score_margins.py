"""By how much a candidate violates or keeps rules, where numbers decide."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.extraction.traces.recorded_drive import Drive
from rulec.logic import formula as ltl
from rulec.logic.formula import atoms_of
from rulec.logic.kleene import Unknown, propositions_that_count
from rulec.monitoring.bindings import Cast
from rulec.monitoring.explain.explained_parts import Deciding
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.explain.margins import Margin, choosing_comparisons, margin_in
from rulec.monitoring.state_view import StateView
from rulec.monitoring.verdict import RuleFor, Violation, rule_for
from rulec.scoring.candidate_score import CandidateScore
from rulec.scoring.charges import at
from rulec.scoring.rescoring import verdicts_of
from rulec.trace.trace_arrays import stretches_of
from rulec.trace.trace_model import present_in
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class RuleMargin:
    """By how much a rule is violated or kept for some objects, in a state of the candidate.

    For a violation it is a margin that decides it, in the state in which it does. Otherwise it is
    in the state in which a comparison that counts there comes nearest to changing its value, as a
    share of the larger of its sides.
    """

    __repr__ = short_repr

    rule: str
    violated: bool
    binding: Mapping[str, str]
    state: int
    margin: Margin


def margins_of(
    candidate: CandidateScore, before: Sequence[Violation], rules: CompiledRulebook, first: int
) -> Iterator[RuleMargin]:
    """The margins of a candidate, whose first state is step ``first`` of the recording.

    ``before`` are the violations of its past. What is violated anew has the margin of that, and
    what ends in time the least one from then on.
    """
    violated_before = {rule_for(violation) for violation in before}
    violated = {rule_for(violation) for violation in candidate.violations}
    nearest: dict[RuleFor, RuleMargin] = {}
    for drive, verdict in verdicts_of(candidate.drives):
        begins = drive.first_step - first
        last = begins + drive.arrays.n_states - 1
        for violation in verdict.violations:
            if rule_for(violation) not in violated_before:
                yield from _deciding(at(violation, begins), drive, rules, begins, None)
        for violation in candidate.violations:
            since = candidate.judged_from.get(rule_for(violation))
            if since is not None and begins <= since <= last:
                yield from _deciding(violation, drive, rules, begins, since)
        untold = {not_judged.rule for not_judged in verdict.not_judged}
        for rule in rules.rules:
            if len(rule.variables) <= 1 and rule.name not in untold:
                late = {about: candidate.late for about in violated_before if about[0] == rule.name}
                for margin in _nearest(rule, drive, rules, violated, (begins, late)):
                    about = rule.name, tuple(margin.binding.values())
                    known = nearest.setdefault(about, margin)
                    if margin.margin.share < known.margin.share:
                        nearest[about] = margin
    yield from nearest.values()


def _deciding(
    violation: Violation, drive: Drive, rules: CompiledRulebook, begins: int, since: int | None
) -> Iterator[RuleMargin]:
    """The margins that decide a violation, which is judged ``since`` a state of the candidate.

    ``begins``: the state of the candidate in which the drive begins.
    """
    cut = 0 if since is None else since - begins
    own = at(violation, -begins - cut)
    decided_by = {name: _DecidedSince(x, cut) for name, x in drive.decided_by.items()}
    names = drive.arrays.world.keys() | drive.arrays.about.keys()
    (arrays,) = stretches_of([drive.arrays], [range(cut, drive.arrays.n_states)], names)
    explanation = explain(own, arrays.trace(), rules, decided_by, repaired=False)
    for margin, state in explanation.measured():
        yield RuleMargin(violation.rule, True, violation.binding, state + cut + begins, margin)


@dataclass(frozen=True, slots=True)
class _DecidedSince:
    """The numbers that decided a signal, in a drive from a ``state`` on."""

    own: Deciding
    state: int

    def margin(self, item: str, state: int) -> Margin | None:
        return self.own.margin(item, self.state + state)


def _nearest(
    rule: CompiledRule,
    drive: Drive,
    rules: CompiledRulebook,
    violated: Collection[RuleFor],
    states_from: tuple[int, Mapping[RuleFor, int]],
) -> Iterator[RuleMargin]:
    """For each choice of objects the state in which a comparison is nearest to changing.

    ``states_from``: the state of the candidate in which the drive begins, and the first states that
    count where it is not the candidate's first.
    """
    trace, (begins, soonest) = drive.trace, states_from
    cast = Cast(trace.objects, rules.vocabulary, len(trace.states), trace.present)
    for binding in cast.bindings(rule):
        about = rule.name, tuple(binding.objects.values())
        if about in violated:
            continue
        states = range(max(binding.first, soonest.get(about, 0) - begins), binding.last + 1)
        found = [
            (margin.share, state, margin)
            for state in states
            for margin in _margins_in(rule, binding.objects, drive, state, rules)
        ]
        if found:
            _, state, margin = min(found, key=lambda one: one[:2])
            yield RuleMargin(rule.name, False, binding.objects, state + begins, margin)


def _margins_in(
    rule: CompiledRule,
    bound: Mapping[str, str],
    drive: Drive,
    state: int,
    rules: CompiledRulebook,
) -> list[Margin]:
    """The margins of what the rule depends on in a state.

    A comparison that only selects what the rule requires, such as whether a sign gives a limit, is
    left out if others remain.
    """
    trace = drive.trace
    objects = present_in(state, trace.objects, trace.present)
    view = StateView(trace.states[state], objects, rules.vocabulary)
    # A comparison that only triggers the rule is not a limit that it sets
    when = set() if rule.trigger is None else set(atoms_of(rule.trigger))
    counted = dict.fromkeys(propositions_that_count(rule.formula, bound, view))
    margins = {
        part: margin
        for part in counted
        if part not in when
        and isinstance(margin := _margin_of(part, bound, drive, state, view), Margin)
    }
    choosing = choosing_comparisons(rule.formula)
    asks = [margin for part, margin in margins.items() if part not in choosing]
    return asks or list(margins.values())


def _margin_of(
    part: ltl.Proposition, bound: Mapping[str, str], drive: Drive, state: int, view: StateView
) -> Margin | Unknown | None:
    """The margin of a comparison, or of the number that decided a signal; None if it is untold."""
    if isinstance(part, ltl.Comparison):
        terms = [term for _, term in part.terms]
        told = [isinstance(x, ltl.QuantityTerm) and x.name in drive.kinds for x in terms]
        return margin_in(part, bound, view) if all(told) else None
    if part.name in drive.decided_by:
        (item,) = (bound[variable] for variable in part.arguments)
        return drive.decided_by[part.name].margin(item, state)
    return None
