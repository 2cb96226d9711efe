"""Binary decision diagrams (Bryant, 1986) over letters and obligations, with the library ``dd``.

A function is an integer of ``dd.bdd``: 1 is true, -1 is false, and negation changes the sign. So
equal functions are equal integers, on every machine.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold


@contextmanager
def _without_graphs() -> Iterator[None]:
    """Keep ``dd`` from importing NetworkX (0.4 s), which it needs only to draw diagrams.

    Nothing else in ``dd`` changes without it.
    """
    if "networkx" in sys.modules:
        yield
        return
    sys.modules["networkx"] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules["networkx"]


with _without_graphs():
    from dd.bdd import BDD

TRUE, FALSE = 1, -1


class _Functions(BDD):
    """Diagrams that are dropped as a whole: skips the search of ``dd`` for leaked references."""

    def __del__(self) -> None:
        pass


class Diagrams:
    """Boolean functions of variables, which are ordered as they are declared."""

    def __init__(self) -> None:
        # The type hints of ``dd`` are incomplete.
        self._functions: Any = _Functions()  # type: ignore[abstract]
        self._supports: dict[int, frozenset[str]] = {1: frozenset()}
        self._letters: dict[ltl.Proposition, str] = {}

    def declare(self, name: str) -> None:
        """Declare a variable below all others."""
        self._functions.add_var(name)

    def variable(self, name: str) -> int:
        """The function that is true where the variable is true."""
        return int(self._functions.var(name))

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
        return int(self._functions.ite(test, yes, no))

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
        level, low, high = self._functions.succ(function)
        name = self._functions.var_at_level(level)
        return (name, low, high) if function > 0 else (name, -low, -high)

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
        met = {name: values[name] for name in self.variables(function) & values.keys()}
        return int(self._functions.let(met, function)) if met else function

    def for_some(self, function: int, names: Iterable[str]) -> int:
        """The function with these variables quantified existentially."""
        return int(self._functions.exist(set(names), function))

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
