"""Which comparison, if its margin were closed, would have kept a rule."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace
from fractions import Fraction

from rulec.logic import formula as ltl
from rulec.logic.linear_comparison import stands
from rulec.monitoring.explain.observed_states import ObservedStates, ObservedWord

_MOST_STATES = 20
"""So many states up to the decisive one are looked through."""

_HAIR = Fraction(1, 10**12)


def turning(
    formula: ltl.Formula,
    word: ObservedWord,
    instants: Mapping[ltl.Formula, Sequence[bool]],
    observed: ObservedStates,
    *,
    when: Set[ltl.Formula],
) -> dict[ltl.Formula, int]:
    """The comparison that is nearest to keeping the rule, and the state where it is.

    Empty if the comparisons that decide do so by themselves, or none does: they are then what there
    is to say. Otherwise they are inner constants of the rule, such as how fast ego may creep after
    a stop that never was. Comparisons in ``when`` only say when the rule applies.
    """
    place = observed.decisive
    word = replace(word, n_states=place + 1)
    asked = [part for part in word.truths if isinstance(part, ltl.Comparison) and part not in when]

    def holds(one: ltl.Comparison | None = None, at: Iterable[int] = ()) -> bool:
        changed = dict(word.truths)
        for own in asked if one is not None else ():
            if one is not None and own.terms == one.terms:
                for instant in at:
                    bit = 1 << instant
                    number = _across(one, holds=not word.truths[one] & bit)
                    is_true = stands(number, own.relation, own.limit)
                    changed[own] = changed[own] | bit if is_true else changed[own] & ~bit
        return replace(word, truths=changed).holds(formula)

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
