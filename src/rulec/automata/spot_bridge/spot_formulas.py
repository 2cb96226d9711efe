"""Formulas in Spot's terms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import spot

from rulec.logic.bounds import Range, range_of
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

F = spot.formula
_STRONG_NEXT = F("X[!]p").kind()
"""Spot's `X` is weak where a word may end, and there is no constructor for the strong one."""


class Wording:
    """Says formulas without operators of the past as Spot's formulas, each part once.

    Automata are made of them over one dictionary of propositions.

    ``names`` are those of its propositions; ``alive`` that of the proposition which is true as long
    as a finite word lasts, None where words go on for ever.
    """

    def __init__(self, names: Mapping[Proposition, str], alive: str | None) -> None:
        self.names = names
        self.alive = alive
        self.dictionary = spot.make_bdd_dict()
        # They are the first variables: so what a letter is can be asked before all else.
        self._keeper = spot.make_twa_graph(self.dictionary)
        for name in sorted({*names.values(), *([] if alive is None else [alive])}):
            self._keeper.register_ap(name)
        self._known: dict[Formula, Any] = {}

    def translated(self, language: Any, *shape: str) -> Any:
        """The automaton of an LTL formula of Spot's. All that share a dictionary go together."""
        return spot.translate(language, *shape, dict=self.dictionary)

    def said(self, formula: Formula) -> Any:
        """The formula; where words are finite, in Spot's LTLf."""
        if formula not in self._known:
            self._known[formula] = self._say(formula)
        return self._known[formula]

    def language(self, formulas: Iterable[Any]) -> Any:
        """The words that all these formulas of Spot's hold for, as an LTL formula."""
        together = F.And(list(formulas))
        return together if self.alive is None else spot.from_ltlf(together, self.alive)

    def _say(self, formula: Formula) -> Any:
        match formula:
            case Atom() | Comparison():
                return F.ap(self.names[formula])
            case Constant(value):
                return F.tt() if value else F.ff()
            case Unary(operator, operand):
                return self._unary(operator, self.said(operand), range_of(formula))
            case Binary(operator, left, right):
                return self._binary(operator, self.said(left), self.said(right), range_of(formula))
            case Same():
                raise ValueError(f"`{formula}` is asked of counted objects, not of a word")

    def _unary(self, operator: UnaryOperator, inner: Any, span: Range) -> Any:
        match operator:
            case UnaryOperator.NOT:
                return F.Not(inner)
            case UnaryOperator.NEXT | UnaryOperator.EVENTUALLY:
                return self._until(F.tt(), inner, span)
            case UnaryOperator.WEAK_NEXT | UnaryOperator.ALWAYS:
                return self._release(F.ff(), inner, span)
            case UnaryOperator.NEVER:
                return self._release(F.ff(), F.Not(inner), span)
        raise ValueError(f"Spot has no operator of the past such as `{operator.value}`")

    def _binary(self, operator: BinaryOperator, left: Any, right: Any, span: Range) -> Any:
        match operator:
            case BinaryOperator.AND:
                return F.And([left, right])
            case BinaryOperator.OR:
                return F.Or([left, right])
            case BinaryOperator.IMPLIES:
                return F.Implies(left, right)
            case BinaryOperator.IFF:
                return F.Equiv(left, right)
            case BinaryOperator.XOR:
                return F.Xor(left, right)
            case BinaryOperator.UNTIL | BinaryOperator.THEN:
                return self._until(left, right, span)
            case BinaryOperator.RELEASE:
                return self._release(left, right, span)
            case BinaryOperator.WEAK_UNTIL if span == (0, None):
                return F.W(left, right)
            case BinaryOperator.WEAK_UNTIL:
                lasting = self._release(F.ff(), left, Range(0, span.high))
                return F.Or([self._until(left, right, span), lasting])
            case BinaryOperator.STRONG_RELEASE if span == (0, None):
                return F.M(left, right)
            case BinaryOperator.STRONG_RELEASE:
                reached = self._until(F.tt(), left, Range(0, span.high))
                return F.And([self._release(left, right, span), reached])
        raise ValueError(f"Spot has no operator of the past such as `{operator.value}`")

    def _until(self, left: Any, right: Any, span: Range) -> Any:
        low, high = span
        if high is not None and high < low:
            return F.ff()
        now = right
        if high is None:
            now = F.U(left, right)
        else:
            for _ in range(high - low):
                now = F.Or([right, F.And([left, self._next(now)])])
        for _ in range(low):
            now = F.And([left, self._next(now)])
        return now

    def _release(self, left: Any, right: Any, span: Range) -> Any:
        low, high = span
        if high is not None and high < low:
            return F.tt()
        now = right
        if high is None:
            now = F.R(left, right)
        else:
            for _ in range(high - low):
                now = F.And([right, F.Or([left, F.X(now)])])
        for _ in range(low):
            now = F.Or([left, F.X(now)])
        return now

    def _next(self, inner: Any) -> Any:
        return F.X(inner) if self.alive is None else F.unop(_STRONG_NEXT, inner)
