"""The operators of temporal logic, said by a few operations on planes of bits.

A plane has a bit for each instant of one trace, or of many. The definitions are those of
``rulec.logic.semantics``; here an operator works on all instants at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Formula,
    Proposition,
    Same,
    Unary,
    UnaryOperator,
)
from rulec.logic.timing import Range, range_of

Plane = TypeVar("Plane")


class Algebra(Protocol[Plane]):
    """What planes can do. Nothing is the case before the first instant.

    After the last one the last goes on for ever, or, on finite words, nothing is the case.
    """

    def constant(self, value: bool) -> Plane:
        """The same at every instant."""

    def no(self, one: Plane) -> Plane:
        """Not."""

    def both(self, one: Plane, other: Plane) -> Plane:
        """And."""

    def either(self, one: Plane, other: Plane) -> Plane:
        """Or."""

    def differ(self, one: Plane, other: Plane) -> Plane:
        """Exclusive or."""

    def ahead(self, one: Plane, steps: int) -> Plane:
        """What is the case so many instants later."""

    def back(self, one: Plane, steps: int) -> Plane:
        """What was the case so many instants earlier."""

    def until(self, left: Plane | None, right: Plane) -> Plane:
        """``right`` now or later, and ``left`` at every instant from now to the one before.

        ``left`` is None if it is the case everywhere.
        """

    def since(self, left: Plane | None, right: Plane) -> Plane:
        """``right`` now or earlier, and ``left`` at every instant after that up to now.

        ``left`` is None if it is the case everywhere.
        """


class Evaluation(Generic[Plane]):
    """A formula on planes; every part of it is evaluated once.

    ``propositions`` gives the planes of atoms and comparisons.
    """

    def __init__(
        self, propositions: Callable[[Proposition], Plane], algebra: Algebra[Plane]
    ) -> None:
        self._propositions = propositions
        self._do = algebra
        # Parts are told apart by identity: a formula's hash takes as long as a plane.
        self._known: dict[int, tuple[Formula, Plane]] = {}

    def plane(self, formula: Formula) -> Plane:
        """The plane of a formula. Its bounds are in steps; ValueError if not."""
        known = self._known.get(id(formula))
        if known is None:
            known = self._known[id(formula)] = (formula, self._evaluated(formula))
        return known[1]

    def _evaluated(self, formula: Formula) -> Plane:
        match formula:
            case Atom() | Comparison():
                return self._propositions(formula)
            case Constant(value):
                return self._do.constant(value)
            case Unary(operator, operand):
                return self._unary(operator, operand, range_of(formula))
            case Binary(operator, left, right):
                span = range_of(formula)
                return self._binary(operator, self.plane(left), self.plane(right), span)
            case Same():
                raise ValueError(f"`{formula}` is asked of counted objects, not of a word")

    def negation(self, formula: Formula) -> Plane:
        """The plane of a formula's negation."""
        match formula:
            case Unary(UnaryOperator.NOT, operand):
                return self.plane(operand)
        return self._do.no(self.plane(formula))

    def _unary(self, operator: UnaryOperator, operand: Formula, span: Range) -> Plane:
        no = self._do.no
        match operator:
            case UnaryOperator.NOT:
                return no(self.plane(operand))
            case UnaryOperator.NEXT | UnaryOperator.EVENTUALLY:
                return self._until(None, self.plane(operand), span)
            case UnaryOperator.WEAK_NEXT | UnaryOperator.ALWAYS:
                return no(self._until(None, self.negation(operand), span))
            case UnaryOperator.NEVER:
                return no(self._until(None, self.plane(operand), span))
            case UnaryOperator.PREVIOUSLY | UnaryOperator.ONCE:
                return self._since(None, self.plane(operand), span)
            case UnaryOperator.WEAK_PREVIOUSLY | UnaryOperator.HISTORICALLY:
                return no(self._since(None, self.negation(operand), span))

    def _binary(self, operator: BinaryOperator, left: Plane, right: Plane, span: Range) -> Plane:
        do, no = self._do, self._do.no
        match operator:
            case BinaryOperator.AND:
                return do.both(left, right)
            case BinaryOperator.OR:
                return do.either(left, right)
            case BinaryOperator.IMPLIES:
                return do.either(no(left), right)
            case BinaryOperator.IFF:
                return no(do.differ(left, right))
            case BinaryOperator.XOR:
                return do.differ(left, right)
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
