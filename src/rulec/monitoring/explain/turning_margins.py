"""Which comparison, if its margin were closed, would have kept a rule."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from fractions import Fraction

from rulec.logic import formula as ltl
from rulec.logic.linear_comparison import stands
from rulec.logic.semantics import extended_by_columns
from rulec.monitoring.explain.observed_states import ObservedStates
from rulec.rulebook.rulebook_model import Semantics

_MOST_STATES = 20
"""So many states up to the decisive one are looked through."""

_HAIR = Fraction(1, 10**12)


def turning(
    formula: ltl.Formula,
    truths: Mapping[ltl.Proposition, Sequence[bool]],
    instants: Mapping[ltl.Formula, Sequence[bool]],
    observed: ObservedStates,
    *,
    semantics: Semantics,
    when: Set[ltl.Formula],
) -> dict[ltl.Formula, int]:
    """The comparison that is nearest to keeping the rule, and the state where it is.

    Empty if the comparisons that decide do so by themselves, or none does: they are then what there
    is to say. Otherwise they are inner constants of the rule, such as how fast ego may creep after
    a stop that never was. Comparisons in ``when`` only say when the rule applies.
    """
    place = observed.decisive
    cut = {part: list(column[: place + 1]) for part, column in truths.items()}
    asked = [part for part in cut if isinstance(part, ltl.Comparison) and part not in when]

    def holds(one: ltl.Comparison | None = None, at: Iterable[int] = ()) -> bool:
        changed = dict(cut)
        for own in asked if one is not None else ():
            if one is not None and own.terms == one.terms:
                changed[own] = list(cut[own])
                for instant in at:
                    number = _across(one, holds=not cut[one][instant])
                    changed[own][instant] = stands(number, own.relation, own.limit)
        return extended_by_columns(formula, changed, place + 1, semantics)[formula][0]

    decide = {
        part: [at for at in range(place + 1) if instants[part][at]]
        for part in asked
        if True in instants.get(part, ())
    }
    if not decide or holds() or all(holds(part, at) for part, at in decide.items()):
        return {}
    nearest: dict[ltl.Formula, int] = {}
    least = None
    for part in asked:
        for at in range(place, max(place - _MOST_STATES, -1), -1):
            margin = observed.margin(part, at) if holds(part, [at]) else None
            if margin is not None and (least is None or margin.by < least):
                nearest, least = {part: at}, margin.by
    return nearest


def _across(comparison: ltl.Comparison, *, holds: bool) -> Fraction:
    """The number next to a comparison's limit by which it holds, or does not."""
    near = (comparison.limit, comparison.limit - _HAIR, comparison.limit + _HAIR)
    return next(x for x in near if stands(x, comparison.relation, comparison.limit) is holds)
