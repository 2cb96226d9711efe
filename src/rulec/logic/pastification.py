"""Bounded duties as conditions on the past, which registers then decide.

What a rule demands from now on can be said when it has failed: `always (p implies eventually[<= b]
q)` is lost where q has been false for b states since p, which asks the past alone (Maler, Nickovic,
Pnueli, "Real time temporal logic: past, present, future", 2005). No state is needed for each step
that is left: the duty that has waited longest decides.
"""

from __future__ import annotations

from collections.abc import Iterator

from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN, PAST, bound_of, operations_of
from rulec.logic.fold import fold_constants
from rulec.logic.formula import FALSE, TRUE, negated
from rulec.logic.semantics import Semantics

_NOT, _AND, _OR = ltl.UnaryOperator.NOT, ltl.BinaryOperator.AND, ltl.BinaryOperator.OR
_LAST = ltl.Unary(ltl.UnaryOperator.WEAK_NEXT, FALSE)
"""Holds in the last state of a finite word, and nowhere in an infinite one."""


class _NoDutyError(Exception):
    """A part demands something that only the future can tell."""


def pastified(formula: ltl.Formula, semantics: Semantics) -> ltl.Formula | None:
    """An equivalent formula whose bounded duties are conditions on the past; None if it has none.

    Both hold for the same words, but not at the same places in them, whatever the step of traces
    is if bounds are in seconds.
    """
    found = _pastified(formula, TRUE, semantics)
    return None if found == formula else found


def _pastified(formula: ltl.Formula, begun: ltl.Formula, semantics: Semantics) -> ltl.Formula:
    """The formula at a word's start, or where ``begun`` is true for the first time."""
    match formula:
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            first = _pastified(left, begun, semantics)
            return ltl.Binary(_AND, first, _pastified(right, begun, semantics))
        case ltl.Binary(
            ltl.BinaryOperator.WEAK_UNTIL,
            ltl.Unary(ltl.UnaryOperator.NOT, start) as before,
            ltl.Binary(ltl.BinaryOperator.AND, again, inner),
            None,
        ) if start == again and begun == TRUE and _is_past(start):
            since = ltl.Unary(ltl.UnaryOperator.ONCE, start)
            then = ltl.Binary(_AND, start, _pastified(inner, since, semantics))
            return ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, before, then)
        case ltl.Unary(
            ltl.UnaryOperator.ALWAYS | ltl.UnaryOperator.NEVER as operator, demanded, None
        ):
            when, is_wanted = begun, operator is ltl.UnaryOperator.ALWAYS
        case _:
            # It is demanded once: at the start.
            before = ltl.Unary(ltl.UnaryOperator.PREVIOUSLY, begun)
            when, demanded, is_wanted = _and(begun, negated(before)), formula, True
    bounded = any(x.bound is not None for x in operations_of(demanded))
    if _is_past(demanded) or not (bounded or when == begun):
        return formula
    try:
        demands = list(_demands(when, demanded, is_wanted, semantics))
    except _NoDutyError:
        return formula
    every = demands[0]
    for demand in demands[1:]:
        every = ltl.Binary(_AND, every, demand)
    return ltl.Unary(ltl.UnaryOperator.ALWAYS, fold_constants(every))


def _is_past(formula: ltl.Formula) -> bool:
    return all(x.operator in PAST or x.operator in BOOLEAN for x in operations_of(formula))


def _demands(
    when: ltl.Formula, formula: ltl.Formula, is_wanted: bool, semantics: Semantics
) -> Iterator[ltl.Formula]:
    """What has to hold in all states, of the past, if a formula does wherever ``when`` holds.

    Or does not, unless it ``is_wanted``. Raises _NoDutyError if the past cannot say it.
    """
    if _is_past(formula):
        yield _implies(when, formula if is_wanted else negated(formula))
        return
    match formula:
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            yield from _demands(when, operand, not is_wanted, semantics)
        case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right):
            yield from _demands(when, ltl.Binary(_OR, negated(left), right), is_wanted, semantics)
        case ltl.Binary(ltl.BinaryOperator.AND | ltl.BinaryOperator.OR as operator, left, right):
            if (operator is _AND) is is_wanted:
                yield from _demands(when, left, is_wanted, semantics)
                yield from _demands(when, right, is_wanted, semantics)
                return
            told, left_open = (left, right) if _is_past(left) else (right, left)
            if not _is_past(told):
                raise _NoDutyError
            without = negated(told) if is_wanted else told
            yield from _demands(_and(when, without), left_open, is_wanted, semantics)
        case ltl.Unary() | ltl.Binary():
            yield from _timed(when, formula, is_wanted, semantics)
        case _:
            raise AssertionError("propositions are about the present")


def _timed(
    when: ltl.Formula, formula: ltl.Unary | ltl.Binary, is_wanted: bool, semantics: Semantics
) -> Iterator[ltl.Formula]:
    """``_demands`` of a temporal operator: an until, or a release of what must hold so long."""
    bound = bound_of(formula)
    left: ltl.Formula
    right: ltl.Formula
    match formula:
        case ltl.Unary(ltl.UnaryOperator.EVENTUALLY, operand):
            is_until, left, right = True, TRUE, operand
        case ltl.Unary(ltl.UnaryOperator.ALWAYS, operand):
            is_until, left, right = False, FALSE, operand
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
            is_until, left, right = False, FALSE, negated(operand)
        case ltl.Binary(ltl.BinaryOperator.UNTIL | ltl.BinaryOperator.THEN, first, then):
            is_until, left, right = True, first, then
        case ltl.Binary(ltl.BinaryOperator.RELEASE, first, then):
            is_until, left, right = False, first, then
        case _:
            raise _NoDutyError
    if not _is_past(left):
        raise _NoDutyError
    if not is_wanted:
        # A release of the opposites is wanted in place of an until, and the other way round
        left, right = negated(left), negated(right)
    if is_until is is_wanted:
        yield from _deadline(when, left, right, bound, semantics)
    else:
        yield from _demands(_still_held(when, left, bound), right, True, semantics)


def _deadline(
    when: ltl.Formula,
    left: ltl.Formula,
    right: ltl.Formula,
    bound: ltl.Bound,
    semantics: Semantics,
) -> Iterator[ltl.Formula]:
    """What holds if ``left until[bound] right`` does wherever ``when`` holds."""
    if bound.low or bound.least or bound.high is None or not _is_past(right):
        raise _NoDutyError
    missing = negated(right)
    asked = _and(when, missing)
    # What has not come at the last instant that there is within the bound comes too late.
    late = ltl.Bound(bound.high, None, bound.unit, early=bound.unit == "s")
    yield negated(_since(missing, asked, late))
    waits = _since(missing, asked, None)
    if left != TRUE:
        yield negated(_and(waits, negated(left)))
    if semantics == "finite":
        yield _implies(_LAST, negated(waits))


def _still_held(when: ltl.Formula, left: ltl.Formula, bound: ltl.Bound) -> ltl.Formula:
    """Where ``left release[bound] right`` still asks for ``right`` because ``when`` has held."""
    if when == TRUE and left == FALSE and not (bound.low or bound.least):
        return TRUE
    if left == FALSE:
        return _since(TRUE, when, bound)
    # ``left`` has released nothing before the present state
    return _since(ltl.Unary(ltl.UnaryOperator.PREVIOUSLY, negated(left)), when, bound)


def _since(left: ltl.Formula, right: ltl.Formula, bound: ltl.Bound | None) -> ltl.Formula:
    return ltl.Binary(ltl.BinaryOperator.SINCE, left, right, bound)


def _and(left: ltl.Formula, right: ltl.Formula) -> ltl.Formula:
    return right if left == TRUE else ltl.Binary(_AND, left, right)


def _implies(left: ltl.Formula, right: ltl.Formula) -> ltl.Formula:
    return right if left == TRUE else ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right)
