"""The evaluation of formulas, from the truth of their propositions in many states."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeAlias

from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN
from rulec.trace.partly_known.partly_known_values import Half, Truth
from rulec.trace.partly_known.temporal_operators import Instants

Parts: TypeAlias = dict[int, tuple[ltl.Formula, Truth[Half]]]
"""Parts and their truth by identity, operands first: hashing a formula takes long."""


@dataclass(frozen=True, slots=True, eq=False)
class FormulaEvaluation(Generic[Half]):
    """The truth of formulas whose propositions, and identities of objects, have a given one.

    The bounds of their operators are in steps. ``parts`` keeps the truth of each part; without it,
    a right operand on which nothing depends is not evaluated.
    """

    proposition: Callable[[ltl.Proposition | ltl.Same], Truth[Half]]
    instants: Instants[Half]
    parts: Parts[Half] | None = None

    def of(self, formula: ltl.Formula) -> Truth[Half]:
        """The truth of a formula."""
        if self.parts is None:
            return self._of(formula)
        if id(formula) not in self.parts:
            truth = self._of(formula)
            self.parts[id(formula)] = formula, truth
        return self.parts[id(formula)][1]

    def _of(self, formula: ltl.Formula) -> Truth[Half]:
        match formula:
            case ltl.Atom() | ltl.Comparison() | ltl.Same():
                return self.proposition(formula)
            case ltl.Constant(value):
                return self.instants.always if value else ~self.instants.always
            case ltl.Unary(operator, operand):
                inner = self.of(operand)
                return ~inner if operator in BOOLEAN else self.instants.unary(formula, inner)
            case ltl.Binary():
                return self._binary(formula)

    def _binary(self, formula: ltl.Binary) -> Truth[Half]:
        first = self.of(formula.left)
        match formula.operator:
            case ltl.BinaryOperator.AND:
                return first & self.of(formula.right) if self._asks(first.possible) else first
            case ltl.BinaryOperator.OR:
                return first | self.of(formula.right) if self._asks(~first.sure) else first
            case ltl.BinaryOperator.IMPLIES:
                return ~first | self.of(formula.right) if self._asks(first.possible) else ~first
            case ltl.BinaryOperator.IFF:
                return first.same_as(self.of(formula.right))
            case ltl.BinaryOperator.XOR:
                return ~first.same_as(self.of(formula.right))
            case _:
                return self.instants.binary(formula, first, self.of(formula.right))

    def _asks(self, half: Half) -> bool:
        """Whether to evaluate what counts in these states only."""
        return self.parts is not None or self.instants.is_somewhere(half)
