"""A shortest trace that a rule forbids, and one that it allows, if possible one much like it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from operator import itemgetter

from rulec.analysis.believable_states import declarations_read, limits_of, plausible_states
from rulec.analysis.counterexample import forbidding_all, shortest_contest
from rulec.analysis.diff.rule_comparison import plain_witnesses
from rulec.analysis.possible_traces import is_possible, said
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.monitoring.state_view import value_in
from rulec.trace import Trace
from rulec.vocabulary import Declaration, Enumeration, Signal
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.state_synthesis import subjects_of
from rulec.witnesses.undecided import UndecidedError


@dataclass(frozen=True, slots=True)
class RuleTraces:
    """The traces, each None if there is none, or both if ``undecided`` says why."""

    accepted: Trace | None
    rejected: Trace | None
    undecided: str = ""


def rule_traces(analyzed: AnalyzedRule) -> RuleTraces:
    """The traces of a rule, with as few objects as it needs."""
    try:
        rejected = _shortest(analyzed, [])
        near = None if rejected is None else _near_miss(analyzed, rejected)
        return RuleTraces(near or _shortest(forbidding_all(analyzed), [analyzed]), rejected)
    except UndecidedError as problem:
        return RuleTraces(None, None, str(problem))


def _shortest(forbidding: AnalyzedRule, allowing: Sequence[AnalyzedRule]) -> Trace | None:
    found = shortest_contest(forbidding, allowing)
    return None if found is None else plain_witnesses(*found, 1)[0]


def _near_miss(analyzed: AnalyzedRule, rejected: Trace) -> Trace | None:
    """A plausible trace that a rule allows, with one value changed, as late as can be.

    What is not as usual becomes so, if that does.
    """
    vocabulary = analyzed.rulebook.vocabulary
    axioms = (*analyzed.axioms, *plausible_states([analyzed.rule], vocabulary))
    universe = ObjectUniverse(rejected.objects, vocabulary, axioms)
    limits = limits_of([analyzed.rule])
    names = declarations_read(analyzed.rule)
    if len(rejected.states) > 1:
        names -= {*vocabulary.constants}
    subjects = [
        (subject, declaration)
        for subject, declaration in subjects_of(vocabulary, rejected.objects, names)
        if len({*subject[1]}) == len(subject[1])
    ]
    for place, state in reversed([*enumerate(rejected.states)]):
        tried = [
            (value != declaration.default, subject, value)
            for subject, declaration in subjects
            if isinstance(own := value_in(state, *subject, declaration), bool | int | float | str)
            for value in _values(declaration, own, limits.get(subject[0], ()))
            if value != own
        ]
        for _, subject, value in sorted(tried, key=itemgetter(0)):
            states = [*rejected.states]
            states[place] = said(state, subject, value)
            changed = replace(rejected, states=tuple(states))
            if is_possible(changed, universe) and not analyzed.violations(changed, vocabulary):
                return changed
    return None


def _values(
    declaration: Declaration, own: bool | float | str, limits: Iterable[Fraction]
) -> list[bool | float | str]:
    """The values to try, nearest first; of a number the default and those near its limits."""
    match declaration:
        case Signal():
            return [not own]
        case Enumeration(values=values):
            here = values.index(str(own))
            return sorted(values, key=lambda value: abs(values.index(value) - here))
    usual = [] if declaration.default is None else [declaration.default]
    near = [float(limit) + by for limit in limits for by in (0, 1, -1)]
    return [*usual, *(number for number in near if number >= min(0, declaration.default or 0))]
