"""Automata of formulas: progression if prefixes decide, breakpoints for recurring conditions."""

from __future__ import annotations

from collections.abc import Iterable
from operator import and_, eq, ne, or_

from rulec.automata.compiler_jobs import BeyondReachError
from rulec.automata.decision_diagrams.diagrams import FALSE, TRUE, Diagrams
from rulec.automata.decision_diagrams.pending_untils import PendingUntils
from rulec.automata.decision_diagrams.symbolic_automaton import (
    SymbolicAutomaton,
    explored,
    joined,
    negated,
)
from rulec.logic import formula as ltl
from rulec.logic.bounds import Range, range_of

_NOT, _AND, _OR = ltl.UnaryOperator.NOT, ltl.BinaryOperator.AND, ltl.BinaryOperator.OR
_ALWAYS, _NEVER = ltl.UnaryOperator.ALWAYS, ltl.UnaryOperator.NEVER
_EVENTUALLY = ltl.UnaryOperator.EVENTUALLY
_CONNECTIVES = {
    _AND: and_,
    _OR: or_,
    ltl.BinaryOperator.IMPLIES: lambda left, right: right or not left,
    ltl.BinaryOperator.IFF: eq,
    ltl.BinaryOperator.XOR: ne,
}


class FormulaAutomata:
    """Automata of past-free formulas over the letters of diagrams; ``ends`` if words are finite."""

    def __init__(self, diagrams: Diagrams, *, ends: bool) -> None:
        self._diagrams = diagrams
        self._untils = PendingUntils(diagrams)
        self._ends = ends
        self._known: dict[ltl.Formula, SymbolicAutomaton] = {}

    def of(self, formula: ltl.Formula) -> SymbolicAutomaton:
        """The automaton of a formula. Raises BeyondReachError."""
        if formula not in self._known:
            self._known[formula] = self._of(formula)
        return self._known[formula]

    def _of(self, formula: ltl.Formula) -> SymbolicAutomaton:
        match formula:
            case ltl.Unary(operator, operand) if operator is _NOT:
                return negated(self.of(operand))
            case ltl.Binary(operator, left, right) if operator in _CONNECTIVES:
                parts = self.of(left), self.of(right)
                return joined(*parts, _CONNECTIVES[operator], self._diagrams)
        function = self._untils.function_of(formula)
        signs = self._untils.signs(function)
        if self._ends or len(signs) < 2:
            return self._progression(function, is_safety=1 not in signs)
        return self._recurring(formula)

    def _progression(self, function: int, *, is_safety: bool) -> SymbolicAutomaton:
        untils = self._untils

        def step(state: int | None) -> Iterable[tuple[int, int, int]]:
            demand = function if state is None else untils.progressed(state)
            for target, letters in untils.split(demand).items():
                kept = target != FALSE if is_safety else target == TRUE
                yield target, int(kept and not self._ends), letters

        first: int | None = None
        states, rows = explored(first, step)
        if not self._ends:
            return SymbolicAutomaton(tuple(rows))
        # The empty word does not exist.
        ends_well = [state is not None and untils.ends_well(state) for state in states]
        return SymbolicAutomaton(tuple(rows), tuple(ends_well))

    def _recurring(self, formula: ltl.Formula) -> SymbolicAutomaton:
        """The automaton of an always, never or eventually whose operand is decided by prefixes."""
        match formula:
            case ltl.Unary(operator, operand) if range_of(formula) == Range(0, None):
                if operator is _NEVER:
                    return self.of(ltl.Unary(_ALWAYS, ltl.Unary(_NOT, operand)))
                if operator is _EVENTUALLY:
                    return negated(self.of(ltl.Unary(_ALWAYS, ltl.Unary(_NOT, operand))))
                if operator is _ALWAYS:
                    return self._always(operand)
        raise BeyondReachError

    def _always(self, operand: ltl.Formula) -> SymbolicAutomaton:
        for operator, polarity in ((_AND, True), (_OR, False)):
            match _without_negations(operand, polarity):
                case ltl.Binary(connective, left, right) if connective is operator:
                    sides = [part if polarity else ltl.Unary(_NOT, part) for part in (left, right)]
                    first, second = [self.of(ltl.Unary(_ALWAYS, side)) for side in sides]
                    return joined(first, second, and_, self._diagrams)
        untils = self._untils
        function = untils.function_of(operand)
        if -1 in untils.signs(function):
            raise BeyondReachError
        diagrams = self._diagrams

        def step(state: tuple[int, int]) -> Iterable[tuple[tuple[int, int], int, int]]:
            # The obligations from before the last breakpoint, and those since then.
            earlier = untils.split(untils.progressed(state[0]))
            since = untils.split(diagrams.both(untils.progressed(state[1]), function))
            edges: dict[tuple[tuple[int, int], int], int] = {}
            for first, letters in earlier.items():
                for second, more in since.items():
                    met = diagrams.both(letters, more)
                    if met == FALSE:
                        continue
                    if FALSE in (first, second):
                        key = (FALSE, FALSE), 0
                    elif first == TRUE:
                        key = (second, TRUE), 1
                    else:
                        key = (first, second), 0
                    edges[key] = diagrams.either(edges.get(key, FALSE), met)
            return [(target, marks, letters) for (target, marks), letters in edges.items()]

        _, rows = explored((TRUE, TRUE), step)
        return SymbolicAutomaton(tuple(rows), is_weak=False)


def _without_negations(formula: ltl.Formula, polarity: bool) -> ltl.Formula:
    """Strip negations: the formula if ``polarity`` comes out true, else the constant true."""
    while isinstance(formula, ltl.Unary) and formula.operator is _NOT:
        formula, polarity = formula.operand, not polarity
    return formula if polarity else ltl.Constant(True)
