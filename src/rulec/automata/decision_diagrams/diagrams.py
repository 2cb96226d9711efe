"""Binary decision diagrams over letters and obligations, of the library ``dd`` (Bryant, 1986).

A function is an integer of ``dd.bdd``: 1 is true, -1 is false, a negation is the negative number.
So equal functions are equal integers, on every machine.
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
    """``dd`` can draw its diagrams as graphs of NetworkX, which takes 0.4 s to load.

    Without it nothing else of ``dd`` changes.
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
    """Diagrams that are dropped as a whole: ``dd`` looks through them again for forgotten ones."""

    def __del__(self) -> None:
        pass


class Diagrams:
    """Functions of variables, which are ordered as they are declared."""

    def __init__(self) -> None:
        # Its types say less than what it does.
        self._functions: Any = _Functions()  # type: ignore[abstract]
        self._supports: dict[int, frozenset[str]] = {1: frozenset()}
        self._letters: dict[ltl.Proposition, str] = {}

    def declare(self, name: str) -> None:
        """Declare a variable below all others."""
        self._functions.add_var(name)

    def variable(self, name: str) -> int:
        """The function that is true where a variable is."""
        return int(self._functions.var(name))

    def declare_letters(self, names: Mapping[ltl.Proposition, str]) -> None:
        """New variables for propositions, by their names."""
        for proposition, name in names.items():
            self.declare(name)
            self._letters[proposition] = name

    def of_letter(self, proposition: ltl.Proposition) -> int:
        """The function that is true where a proposition is."""
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
        """The first variable of a function, and what is left where it is false, and where true.

        The function is no constant.
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
        """The function where some variables have these values."""
        met = {name: values[name] for name in self.variables(function) & values.keys()}
        return int(self._functions.let(met, function)) if met else function

    def for_some(self, function: int, names: Iterable[str]) -> int:
        """The function that is true where some values of these variables make it so."""
        return int(self._functions.exist(set(names), function))

    def copied(self, function: int, to: Diagrams) -> int:
        """The function of the variables of the same names in other diagrams."""
        if abs(function) == 1:
            return function
        name, low, high = self.parts(function)
        return to.ite(to.variable(name), self.copied(high, to), self.copied(low, to))

    def of_state(self, formula: ltl.Formula) -> int:
        """The function of a formula without temporal operators."""
        return fold(formula, self.algebra())

    def algebra(self) -> Algebra[int]:
        """What propositions and the connectives mean."""
        return Algebra(
            proposition=self.of_letter,
            constant=lambda value: TRUE if value else FALSE,
            negation=lambda function: -function,
            conjunction=self.both,
            disjunction=self.either,
            equivalence=self.alike,
        )

    def cubes(self, function: int) -> Iterator[dict[str, bool]]:
        """Disjoint conjunctions of literals that make up a function."""
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
        """A function of letters as a bit set of them; ``sets`` are where variables are true.

        ``known`` keeps what has been found, and has that of ``TRUE``: all letters.
        """
        bits = known.get(abs(function))
        if bits is None:
            name, low, high = self.parts(abs(function))
            true, everything = sets[name], known[TRUE]
            bits = known[abs(function)] = (true & self.bits(high, sets, known)) | (
                everything & ~true & self.bits(low, sets, known)
            )
        return bits if function > 0 else known[TRUE] & ~bits
