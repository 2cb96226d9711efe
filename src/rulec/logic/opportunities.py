"""Opportunities to violate a rule: its trigger, and where it is breached.

A rule demands something where its trigger holds: the left side of an implication, the first phase
of a sequence, all parts of a prohibited conjunction but the last. So exposure can be counted as in
traffic psychology (Chapman, "The concept of exposure", 1973): an opportunity is one stretch of
states in which the trigger holds. The trigger is derived from the formula's form; docs/rates.md
lists the forms.
"""

from __future__ import annotations

from collections.abc import Iterable

from rulec.logic import formula as ltl
from rulec.logic.fold import fold_constants

_GUARDING = (ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER)

BEGINNING: ltl.Formula = ltl.Unary(ltl.UnaryOperator.WEAK_PREVIOUSLY, ltl.Constant(False))
"""A formula that holds in the first state only."""


def breach_of(formula: ltl.Formula) -> ltl.Formula:
    """A formula that holds in a state if the formula is violated there.

    A word violates the formula if and only if this holds in one of its states. A formula that is
    not of the form ``always`` or ``never`` is violated in the first state.
    """
    return fold_constants(_breach(formula) or _at_first(ltl.negated(formula)))


def trigger_of(
    required: ltl.Formula,
    exceptions: Iterable[tuple[ltl.Formula, bool]] = (),
    condition: ltl.Formula | None = None,
) -> ltl.Formula | None:
    """The condition for a breach in a state; None if the formula's form does not show one.

    ``required`` is the rule's formula without its exceptions; each of these is paired with whether
    it is about the first state. Those about a single state count only if
    ``guards_one_state(required)``: a sequence's are about states after its first phase.
    """
    trigger = _trigger(required)
    parts = [] if trigger is None else [trigger]
    apart: list[ltl.Formula] = []
    initially: list[ltl.Formula] = []
    for exception, is_initial in exceptions:
        (initially if is_initial else apart).append(ltl.negated(exception))
    if condition is not None:
        guards = isinstance(required, ltl.Unary) and required.operator in _GUARDING
        (apart if guards else initially).append(condition)
    if guards_one_state(required):
        parts += apart
    parts += map(_at_first_once, initially)
    formula = fold_constants(ltl.all_of(parts)) if parts else None
    return None if formula == ltl.TRUE else formula


def guards_one_state(formula: ltl.Formula) -> bool:
    """Whether a rule has the form ``always p`` or ``never p`` where p is not a sequence."""
    match formula:
        case ltl.Unary(ltl.UnaryOperator.ALWAYS):
            return True
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
            return not (
                isinstance(operand, ltl.Binary) and operand.operator is ltl.BinaryOperator.THEN
            )
    return False


def _breach(formula: ltl.Formula) -> ltl.Formula | None:
    match formula:
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            return ltl.any_of([_breach_at_all(left), _breach_at_all(right)])
        case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right):
            later = _breach(right)
            return None if later is None else ltl.all_of([later, _at_first_once(left)])
        case ltl.Binary(ltl.BinaryOperator.OR, left, right):
            first, second = _breach(left), _breach(right)
            if (first is None) == (second is None):
                return None
            later, other = (first, right) if second is None else (second, left)
            return (
                None if later is None else ltl.all_of([later, _at_first_once(ltl.negated(other))])
            )
        case ltl.Unary(ltl.UnaryOperator.ALWAYS, operand, bound):
            return _within(ltl.negated(operand), bound)
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand, bound):
            return _within(_without_lead(operand), bound)
        case ltl.Unary(
            ltl.UnaryOperator.NOT, ltl.Unary(ltl.UnaryOperator.EVENTUALLY, operand, bound)
        ):
            return _within(_without_lead(operand), bound)
    return None


def _breach_at_all(formula: ltl.Formula) -> ltl.Formula:
    return _breach(formula) or _at_first(ltl.negated(formula))


def _within(formula: ltl.Formula, bound: ltl.Bound | None) -> ltl.Formula:
    """The formula within the bound of the ``always`` or ``never`` around it."""
    return formula if bound is None else ltl.all_of([formula, _reached(bound)])


def _reached(bound: ltl.Bound) -> ltl.Formula:
    return ltl.Unary(ltl.UnaryOperator.ONCE, BEGINNING, bound)


def _without_lead(formula: ltl.Formula) -> ltl.Formula:
    """A sequence without leading phases of ``true``, which only require earlier states."""
    match formula:
        case ltl.Binary(ltl.BinaryOperator.THEN, ltl.Constant(True), rest, None):
            later = ltl.Unary(ltl.UnaryOperator.PREVIOUSLY, ltl.TRUE)
            return ltl.all_of([_without_lead(rest), later])
    return formula


def _trigger(formula: ltl.Formula) -> ltl.Formula | None:
    match formula:
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            return _either(_trigger(left), _trigger(right))
        case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right) if _breach(right) is not None:
            return ltl.all_of([_at_first_once(left), _trigger(right) or ltl.TRUE])
        case ltl.Binary(ltl.BinaryOperator.OR, left, right) if _breach(formula) is not None:
            guarding, other = (left, right) if _breach(right) is None else (right, left)
            return ltl.all_of([_at_first_once(ltl.negated(other)), _trigger(guarding) or ltl.TRUE])
        case ltl.Unary(ltl.UnaryOperator.ALWAYS, operand, bound):
            return _bounded(_condition(operand), bound)
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand, bound):
            return _bounded(_beginning(operand), bound)
        case ltl.Unary(
            ltl.UnaryOperator.NOT, ltl.Unary(ltl.UnaryOperator.EVENTUALLY, operand, bound)
        ):
            return _bounded(_beginning(operand), bound)
    return None


def _bounded(trigger: ltl.Formula | None, bound: ltl.Bound | None) -> ltl.Formula | None:
    if bound is None:
        return trigger
    return ltl.all_of([trigger or ltl.TRUE, _reached(bound)])


def _condition(formula: ltl.Formula) -> ltl.Formula | None:
    """The condition under which a formula that must always hold demands something."""
    match formula:
        case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right):
            return ltl.all_of([left, _condition(right) or ltl.TRUE])
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            return _either(_condition(left), _condition(right))
        case ltl.Binary(ltl.BinaryOperator.OR):
            parts = list(ltl.chain_of(ltl.BinaryOperator.OR, formula))
            asking = [(part, _condition(part)) for part in parts]
            conditions = [condition for _, condition in asking if condition is not None]
            others = [ltl.negated(part) for part, condition in asking if condition is None]
            return ltl.all_of([*others, *conditions]) if conditions else None
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return _beginning(operand)
    return None


def _beginning(formula: ltl.Formula) -> ltl.Formula | None:
    """The trigger of a ``never``: a sequence's first phase, a conjunction without its last part."""
    match formula:
        case ltl.Binary(ltl.BinaryOperator.THEN, left, right):
            return left if left != ltl.TRUE else _beginning(right) or right
        case ltl.Binary(ltl.BinaryOperator.AND):
            parts = [
                part for part in ltl.chain_of(ltl.BinaryOperator.AND, formula) if part != ltl.TRUE
            ]
            last = _beginning(parts[-1]) if parts else None
            before = [*parts[:-1], *([] if last is None else [last])]
            return ltl.all_of(before) if before else None
        case ltl.Binary(ltl.BinaryOperator.OR, left, right):
            return _either(_beginning(left), _beginning(right))
    return None


def _either(left: ltl.Formula | None, right: ltl.Formula | None) -> ltl.Formula | None:
    return None if left is None or right is None else ltl.any_of([left, right])


def _at_first(formula: ltl.Formula) -> ltl.Formula:
    return ltl.all_of([formula, BEGINNING])


def _at_first_once(formula: ltl.Formula) -> ltl.Formula:
    """A formula that held in the first state."""
    return ltl.Unary(ltl.UnaryOperator.ONCE, _at_first(formula))
