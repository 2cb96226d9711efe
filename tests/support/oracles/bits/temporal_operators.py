"""The operators of temporal logic, said by a few operations on planes of bits.

The definitions are those of ``rulec.logic.semantics``; here an operator works on all instants at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic

from rulec.logic.bounds import Range, range_of
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Formula,
    Same,
    Unary,
    UnaryOperator,
)
from support.oracles.bits.plane_algebra import Algebra, Plane

_AT_ONCE = frozenset(
    {
        BinaryOperator.AND,
        BinaryOperator.OR,
        BinaryOperator.IMPLIES,
        BinaryOperator.IFF,
        BinaryOperator.XOR,
    }
)
"""What is the case at an instant depends on nothing but that instant."""


class Evaluation(Generic[Plane]):
    """Formulas, whose bounds are in steps, on planes of an algebra."""

    def __init__(self, algebra: Algebra[Plane]) -> None:
        self._do = algebra

    def at_first(self, formula: Formula) -> Plane:
        """The row of a formula at the first instant, and no more of it than that takes.

        ValueError if its bounds are not in steps, or if it asks whether objects are the same.
        """
        do = self._do
        match formula:
            case Atom() | Comparison():
                return do.given_first(formula)
            case Unary(UnaryOperator.NOT, operand):
                return do.opposite(self.at_first(operand))
            case Unary(UnaryOperator.ALWAYS, operand, None):
                return do.opposite(do.ever(do.no(self.plane(operand))))
            case Unary(UnaryOperator.NEVER, operand, None):
                return do.opposite(do.ever(self.plane(operand)))
            case Unary(UnaryOperator.EVENTUALLY, operand, None):
                return do.ever(self.plane(operand))
            case Binary(operator, left, right) if operator in _AT_ONCE:
                one, other = self.at_first(left), self.at_first(right)
                return self._at_once(operator, one, other, do.opposite)
        return do.first(self.plane(formula))

    def plane(self, formula: Formula) -> Plane:
        """When a formula is true."""
        match formula:
            case Atom() | Comparison():
                return self._do.given(formula)
            case Constant(value):
                return self._do.constant(value)
            case Unary(operator, operand):
                return self._unary(operator, self.plane(operand), range_of(formula))
            case Binary(operator, left, right):
                span = range_of(formula)
                return self._binary(operator, self.plane(left), self.plane(right), span)
            case Same():
                raise ValueError(f"`{formula}` is asked of counted objects, not of a word")

    def _unary(self, operator: UnaryOperator, operand: Plane, span: Range) -> Plane:
        no = self._do.no
        match operator:
            case UnaryOperator.NOT:
                return no(operand)
            case UnaryOperator.NEXT | UnaryOperator.EVENTUALLY:
                return self._until(None, operand, span)
            case UnaryOperator.WEAK_NEXT | UnaryOperator.ALWAYS:
                return no(self._until(None, no(operand), span))
            case UnaryOperator.NEVER:
                return no(self._until(None, operand, span))
            case UnaryOperator.PREVIOUSLY | UnaryOperator.ONCE:
                return self._since(None, operand, span)
            case UnaryOperator.WEAK_PREVIOUSLY | UnaryOperator.HISTORICALLY:
                return no(self._since(None, no(operand), span))

    def _at_once(
        self, operator: BinaryOperator, one: Plane, other: Plane, no: Callable[[Plane], Plane]
    ) -> Plane:
        match operator:
            case BinaryOperator.AND:
                return self._do.both(one, other)
            case BinaryOperator.OR:
                return self._do.either(one, other)
            case BinaryOperator.IMPLIES:
                return self._do.either(no(one), other)
            case BinaryOperator.IFF:
                return no(self._do.differ(one, other))
            case _:
                return self._do.differ(one, other)

    def _binary(self, operator: BinaryOperator, left: Plane, right: Plane, span: Range) -> Plane:
        no = self._do.no
        match operator:
            case BinaryOperator.UNTIL | BinaryOperator.THEN:
                return self._until(left, right, span)
            case BinaryOperator.WEAK_UNTIL:
                return self._weak_until(left, right, span)
            case BinaryOperator.RELEASE:
                return no(self._until(no(left), no(right), span))
            case BinaryOperator.STRONG_RELEASE:
                return no(self._weak_until(no(left), no(right), span))
            case BinaryOperator.SINCE:
                return self._since(left, right, span)
            case _:
                return self._at_once(operator, left, right, no)

    def _weak_until(self, left: Plane, right: Plane, span: Range) -> Plane:
        """As ``_until``, or ``left`` from here to the range's end."""
        do = self._do
        breaks = self._until(None, do.no(left), Range(0, span.high))
        return do.either(self._until(left, right, span), do.no(breaks))

    def _until(self, left: Plane | None, right: Plane, span: Range) -> Plane:
        return self._reached(left, right, span, self._do.until, self._do.ahead)

    def _since(self, left: Plane | None, right: Plane, span: Range) -> Plane:
        return self._reached(left, right, span, self._do.since, self._do.back)

    def _reached(
        self,
        left: Plane | None,
        right: Plane,
        span: Range,
        unbounded: Callable[[Plane | None, Plane], Plane],
        move: Callable[[Plane, int], Plane],
    ) -> Plane:
        """``right`` within the range, ``left`` on the way there; ``move`` goes in its direction.

        A range of n instants is put together from ranges of 1, 2, 4, … instants.
        """
        if span.high is None:
            found = unbounded(left, right)
        elif span.high < span.low:
            return self._do.constant(False)
        else:
            found, _ = self._within(left, right, span.high - span.low + 1, move)
        if span.low == 0:
            return found
        reached = move(found, span.low)
        if left is None:
            return reached
        _, way = self._within(left, right, span.low, move)
        return reached if way is None else self._do.both(way, reached)

    def _within(
        self, left: Plane | None, right: Plane, n_instants: int, move: Callable[[Plane, int], Plane]
    ) -> tuple[Plane, Plane | None]:
        """``right`` within so many instants, ``left`` on the way; and ``left`` at all of them."""
        if n_instants == 1:
            return right, left
        half = n_instants // 2
        found, way = self._within(left, right, half, move)
        if n_instants % 2:
            # One instant now, the rest later.
            more, further = self._joined((found, way), (found, way), half, move)
            return self._joined((right, left), (more, further), 1, move)
        return self._joined((found, way), (found, way), half, move)

    def _joined(
        self,
        near: tuple[Plane, Plane | None],
        far: tuple[Plane, Plane | None],
        steps: int,
        move: Callable[[Plane, int], Plane],
    ) -> tuple[Plane, Plane | None]:
        """The same for two ranges, the second ``steps`` behind the first."""
        do, (found, way) = self._do, near
        later, further = move(far[0], steps), far[1]
        if way is None or further is None:
            return do.either(found, later), None
        return do.either(found, do.both(way, later)), do.both(way, move(further, steps))
