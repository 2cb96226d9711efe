"""Opportunities to violate a rule: its trigger, and where it is breached.

A rule demands something where its trigger holds: the left side of an implication, the first phase
of a sequence, all parts of a prohibited conjunction but the last. So exposure can be counted as in
traffic psychology (Chapman, "The concept of exposure", 1973): an opportunity is one stretch of
states in which the trigger holds. The trigger is derived from the formula's form; docs/rates.md
lists the forms.
"""

from __future__ import annotations

from collections.abc import Iterable

from rulec.logic.fold import fold_constants
from rulec.logic.formula import (
    TRUE,
    Binary,
    BinaryOperator,
    Bound,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    all_of,
    any_of,
    chain_of,
    negated,
)

_GUARDING = (UnaryOperator.ALWAYS, UnaryOperator.NEVER)

BEGINNING: Formula = Unary(UnaryOperator.WEAK_PREVIOUSLY, Constant(False))
"""A formula that holds in the first state only."""


def breach_of(formula: Formula) -> Formula:
    """A formula that holds in a state if the formula is violated there.

    A word violates the formula if and only if this holds in one of its states. A formula that is
    not of the form ``always`` or ``never`` is violated in the first state.
    """
    return fold_constants(_breach(formula) or _at_first(negated(formula)))


def trigger_of(
    required: Formula,
    exceptions: Iterable[tuple[Formula, bool]] = (),
    condition: Formula | None = None,
) -> Formula | None:
    """The condition for a breach in a state; None if the formula's form does not show one.

    ``required`` is the rule's formula without its exceptions; each of these is paired with whether
    it is about the first state. Those about a single state count only if
    ``guards_one_state(required)``: a sequence's are about states after its first phase.
    """
    trigger = _trigger(required)
    parts = [] if trigger is None else [trigger]
    apart: list[Formula] = []
    initially: list[Formula] = []
    for exception, is_initial in exceptions:
        (initially if is_initial else apart).append(negated(exception))
    if condition is not None:
        guards = isinstance(required, Unary) and required.operator in _GUARDING
        (apart if guards else initially).append(condition)
    if guards_one_state(required):
        parts += apart
    parts += map(_at_first_once, initially)
    formula = fold_constants(all_of(parts)) if parts else None
    return None if formula == TRUE else formula


def guards_one_state(formula: Formula) -> bool:
    """Whether a rule has the form ``always p`` or ``never p`` where p is not a sequence."""
    match formula:
        case Unary(UnaryOperator.ALWAYS):
            return True
        case Unary(UnaryOperator.NEVER, operand):
            return not (isinstance(operand, Binary) and operand.operator is BinaryOperator.THEN)
    return False


def _breach(formula: Formula) -> Formula | None:
    match formula:
        case Binary(BinaryOperator.AND, left, right):
            return any_of([_breach_at_all(left), _breach_at_all(right)])
        case Binary(BinaryOperator.IMPLIES, left, right):
            later = _breach(right)
            return None if later is None else all_of([later, _at_first_once(left)])
        case Binary(BinaryOperator.OR, left, right):
            first, second = _breach(left), _breach(right)
            if (first is None) == (second is None):
                return None
            later, other = (first, right) if second is None else (second, left)
            return None if later is None else all_of([later, _at_first_once(negated(other))])
        case Unary(UnaryOperator.ALWAYS, operand, bound):
            return _within(negated(operand), bound)
        case Unary(UnaryOperator.NEVER, operand, bound):
            return _within(_without_lead(operand), bound)
        case Unary(UnaryOperator.NOT, Unary(UnaryOperator.EVENTUALLY, operand, bound)):
            return _within(_without_lead(operand), bound)
    return None


def _breach_at_all(formula: Formula) -> Formula:
    return _breach(formula) or _at_first(negated(formula))


def _within(formula: Formula, bound: Bound | None) -> Formula:
    """The formula within the bound of the ``always`` or ``never`` around it."""
    return formula if bound is None else all_of([formula, _reached(bound)])


def _reached(bound: Bound) -> Formula:
    return Unary(UnaryOperator.ONCE, BEGINNING, bound)


def _without_lead(formula: Formula) -> Formula:
    """A sequence without leading phases of ``true``, which only require earlier states."""
    match formula:
        case Binary(BinaryOperator.THEN, Constant(True), rest, None):
            later = Unary(UnaryOperator.PREVIOUSLY, TRUE)
            return all_of([_without_lead(rest), later])
    return formula


def _trigger(formula: Formula) -> Formula | None:
    match formula:
        case Binary(BinaryOperator.AND, left, right):
            return _either(_trigger(left), _trigger(right))
        case Binary(BinaryOperator.IMPLIES, left, right) if _breach(right) is not None:
            return all_of([_at_first_once(left), _trigger(right) or TRUE])
        case Binary(BinaryOperator.OR, left, right) if _breach(formula) is not None:
            guarding, other = (left, right) if _breach(right) is None else (right, left)
            return all_of([_at_first_once(negated(other)), _trigger(guarding) or TRUE])
        case Unary(UnaryOperator.ALWAYS, operand, bound):
            return _bounded(_condition(operand), bound)
        case Unary(UnaryOperator.NEVER, operand, bound):
            return _bounded(_beginning(operand), bound)
        case Unary(UnaryOperator.NOT, Unary(UnaryOperator.EVENTUALLY, operand, bound)):
            return _bounded(_beginning(operand), bound)
    return None


def _bounded(trigger: Formula | None, bound: Bound | None) -> Formula | None:
    if bound is None:
        return trigger
    return all_of([trigger or TRUE, _reached(bound)])


def _condition(formula: Formula) -> Formula | None:
    """The condition under which a formula that must always hold demands something."""
    match formula:
        case Binary(BinaryOperator.IMPLIES, left, right):
            return all_of([left, _condition(right) or TRUE])
        case Binary(BinaryOperator.AND, left, right):
            return _either(_condition(left), _condition(right))
        case Binary(BinaryOperator.OR):
            parts = list(chain_of(BinaryOperator.OR, formula))
            asking = [(part, _condition(part)) for part in parts]
            conditions = [condition for _, condition in asking if condition is not None]
            others = [negated(part) for part, condition in asking if condition is None]
            return all_of([*others, *conditions]) if conditions else None
        case Unary(UnaryOperator.NOT, operand):
            return _beginning(operand)
    return None


def _beginning(formula: Formula) -> Formula | None:
    """The trigger of a ``never``: a sequence's first phase, a conjunction without its last part."""
    match formula:
        case Binary(BinaryOperator.THEN, left, right):
            return left if left != TRUE else _beginning(right) or right
        case Binary(BinaryOperator.AND):
            parts = [part for part in chain_of(BinaryOperator.AND, formula) if part != TRUE]
            last = _beginning(parts[-1]) if parts else None
            before = [*parts[:-1], *([] if last is None else [last])]
            return all_of(before) if before else None
        case Binary(BinaryOperator.OR, left, right):
            return _either(_beginning(left), _beginning(right))
    return None


def _either(left: Formula | None, right: Formula | None) -> Formula | None:
    return None if left is None or right is None else any_of([left, right])


def _at_first(formula: Formula) -> Formula:
    return all_of([formula, BEGINNING])


def _at_first_once(formula: Formula) -> Formula:
    """A formula that held in the first state."""
    return Unary(UnaryOperator.ONCE, _at_first(formula))
