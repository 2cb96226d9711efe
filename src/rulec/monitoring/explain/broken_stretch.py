"""The states over which a condition that must hold always, or never, is broken."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from rulec.logic import formula as ltl
from rulec.monitoring.explain.observed_states import ObservedStates, ObservedWord


def broken_stretch(
    formula: ltl.Formula,
    values: Mapping[ltl.Formula, list[bool]],
    word: ObservedWord,
    observed: ObservedStates,
) -> tuple[int, int]:
    """The stretch around the decisive state in which an outermost always or never is broken.

    A forbidden sequence of phases, such as overtaking, lasts from the latest state in which it can
    have begun to the decisive one. The stretch ends where states have been left out.
    """
    decisive, numbers = observed.decisive, observed.numbers
    for part, wanted in _bodies(formula):
        if not wanted and _has_phases(part):
            # The last phase may only require that something continues
            for n_states in (decisive + 1, decisive + 2):
                done = word.up_to(decisive, n_states).parts(part)[part]
                begins = [n for n in range(decisive, -1, -1) if done[n]]
                if begins:
                    return begins[0], decisive
        column = values[part]
        broken = [n for n in range(decisive, -1, -1) if column[n] is not wanted]
        if broken:
            first = last = broken[0]
            while (
                first > 0
                and column[first - 1] is not wanted
                and numbers[first - 1] == numbers[first] - 1
            ):
                first -= 1
            while last + 1 < len(column) and column[last + 1] is not wanted:
                last += 1
            return first, max(last, decisive)
    return decisive, decisive


def is_broken_before(
    first: int, formula: ltl.Formula, values: Mapping[ltl.Formula, list[bool]]
) -> bool:
    """Whether the body of an outermost always or never is broken in a state before ``first``."""
    return any(
        wanted is not value for part, wanted in _bodies(formula) for value in values[part][:first]
    )


def _bodies(formula: ltl.Formula) -> Iterator[tuple[ltl.Formula, bool]]:
    """The conditions that must be true, or false, in all states, each with which of both."""
    match formula:
        case ltl.Unary(ltl.UnaryOperator.ALWAYS, body, None):
            yield body, True
        case ltl.Unary(ltl.UnaryOperator.NEVER, body, None):
            yield body, False
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            yield from _bodies(left)
            yield from _bodies(right)
        case ltl.Binary(ltl.BinaryOperator.IMPLIES | ltl.BinaryOperator.OR, _, right):
            yield from _bodies(right)


def _has_phases(formula: ltl.Formula) -> bool:
    match formula:
        case ltl.Unary(_, operand):
            return _has_phases(operand)
        case ltl.Binary(operator, left, right):
            phases = operator is ltl.BinaryOperator.THEN
            return phases or _has_phases(left) or _has_phases(right)
        case _:
            return False
