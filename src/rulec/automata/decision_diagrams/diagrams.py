"""Binary decision diagrams (Bryant, 1986) over letters and obligations.

A function is an integer: 1 is true, -1 is false, any other one a node's number, and negation
changes the sign (Brace, Rudell, Bryant, 1990). So equal functions are equal integers, and as nodes
are numbered in the order of their making, the same ones on every machine.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold

TRUE, FALSE = 1, -1


class Diagrams:
    """Boolean functions of variables, which are ordered as they are declared."""

    def __init__(self) -> None:
        self._levels: dict[str, int] = {}
        self._names: list[str] = []
        # Level, and the functions for false and for true, of each node; the latter is never a
        # negation. There is no node 0, and node 1 is below all variables.
        self._nodes = [(sys.maxsize, 0, 0)] * 2
        self._numbers: dict[tuple[int, int, int], int] = {}
        self._chosen: dict[tuple[int, int, int], int] = {}
        self._supports: dict[int, frozenset[str]] = {1: frozenset()}
        self._letters: dict[ltl.Proposition, str] = {}

    def declare(self, name: str) -> None:
        """Declare a variable below all others."""
        if name not in self._levels:
            self._levels[name] = len(self._names)
            self._names.append(name)

    def variable(self, name: str) -> int:
        """The function that is true where the variable is true."""
        return self._node(self._levels[name], FALSE, TRUE)

    def declare_letters(self, names: Mapping[ltl.Proposition, str]) -> None:
        """Declare a new variable for each proposition, with the given name."""
        for proposition, name in names.items():
            self.declare(name)
            self._letters[proposition] = name

    def of_letter(self, proposition: ltl.Proposition) -> int:
        """The function that is true where a proposition is true."""
        return self.variable(self._letters[proposition])

    def ite(self, test: int, yes: int, no: int) -> int:
        """If ``test`` then ``yes``, else ``no``."""
        if yes == no or test == TRUE:
            return yes
        if test == FALSE:
            return no
        key = (test, yes, no)
        chosen = self._chosen.get(key)
        if chosen is None:
            nodes = self._nodes
            level = min(nodes[abs(test)][0], nodes[abs(yes)][0], nodes[abs(no)][0])
            test_low, test_high = self._cofactors(test, level)
            yes_low, yes_high = self._cofactors(yes, level)
            no_low, no_high = self._cofactors(no, level)
            low = self.ite(test_low, yes_low, no_low)
            chosen = self._node(level, low, self.ite(test_high, yes_high, no_high))
            self._chosen[key] = chosen
        return chosen

    def _node(self, level: int, low: int, high: int) -> int:
        if low == high:
            return low
        if high < 0:
            return -self._node(level, -low, -high)
        number = self._numbers.setdefault((level, low, high), len(self._nodes))
        if number == len(self._nodes):
            self._nodes.append((level, low, high))
        return number

    def _cofactors(self, function: int, level: int) -> tuple[int, int]:
        """A function where the variable of a level, not below its own, is false, and true."""
        own, low, high = self._nodes[abs(function)]
        if own != level:
            return function, function
        return (low, high) if function > 0 else (-low, -high)

    def both(self, left: int, right: int) -> int:
        """Conjunction."""
        return self.ite(left, right, FALSE)

    def either(self, left: int, right: int) -> int:
        """Disjunction."""
        return self.ite(left, TRUE, right)

    def alike(self, left: int, right: int) -> int:
        """Equivalence."""
        return self.ite(left, right, -right)

    def parts(self, function: int) -> tuple[str, int, int]:
        """The top variable of a non-constant function, and its cofactors for false and for true.

        The function must not be constant.
        """
        level = self._nodes[abs(function)][0]
        return self._names[level], *self._cofactors(function, level)

    def variables(self, function: int) -> frozenset[str]:
        """The variables that a function depends on."""
        known = self._supports.get(abs(function))
        if known is None:
            name, low, high = self.parts(abs(function))
            known = self._supports[abs(function)] = (
                self.variables(low) | self.variables(high) | {name}
            )
        return known

    def given(self, function: int, values: Mapping[str, bool]) -> int:
        """The function with some variables fixed to these values."""
        return self._decided(function, {self._levels[name]: values[name] for name in values}, {})

    def for_some(self, function: int, names: Iterable[str]) -> int:
        """The function with these variables quantified existentially."""
        return self._decided(function, dict.fromkeys(map(self._levels.__getitem__, names)), {})

    def _decided(
        self, function: int, values: Mapping[int, bool | None], known: dict[int, int]
    ) -> int:
        """The function with the variables of these levels fixed, or, for None, quantified."""
        decided = known.get(function)
        if decided is not None:
            return decided
        level = self._nodes[abs(function)][0]
        if level > max(values, default=-1):
            return function
        low, high = self._cofactors(function, level)
        value = values.get(level)
        low = FALSE if value is True else self._decided(low, values, known)
        high = FALSE if value is False else self._decided(high, values, known)
        decided = self.either(low, high) if level in values else self._node(level, low, high)
        known[function] = decided
        return decided

    def copied(self, function: int, to: Diagrams) -> int:
        """The same function, over the variables of the same names, in other diagrams."""
        if abs(function) == 1:
            return function
        name, low, high = self.parts(function)
        return to.ite(to.variable(name), self.copied(high, to), self.copied(low, to))

    def of_state(self, formula: ltl.Formula) -> int:
        """The function of a formula without temporal operators."""
        return fold(formula, self.algebra())

    def algebra(self) -> Algebra[int]:
        """The interpretation of propositions and connectives as functions."""
        return Algebra(
            proposition=self.of_letter,
            constant=lambda value: TRUE if value else FALSE,
            negation=lambda function: -function,
            conjunction=self.both,
            disjunction=self.either,
            equivalence=self.alike,
        )

    def cubes(self, function: int) -> Iterator[dict[str, bool]]:
        """Disjoint conjunctions of literals whose disjunction is the function."""
        if function == FALSE:
            return
        if function == TRUE:
            yield {}
            return
        name, low, high = self.parts(function)
        for value, part in ((False, low), (True, high)):
            for cube in self.cubes(part):
                yield {name: value, **cube}

    def bits(self, function: int, sets: Mapping[str, int], known: dict[int, int]) -> int:
        """The bit set of letters for which a function is true; ``sets`` has that of each variable.

        ``known`` caches results and must contain the set for ``TRUE``: all letters.
        """
        bits = known.get(abs(function))
        if bits is None:
            name, low, high = self.parts(abs(function))
            true, everything = sets[name], known[TRUE]
            bits = known[abs(function)] = (true & self.bits(high, sets, known)) | (
                everything & ~true & self.bits(low, sets, known)
            )
        return bits if function > 0 else known[TRUE] & ~bits
