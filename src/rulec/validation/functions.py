"""Positive Boolean functions of demands in a normal form, and maps from such values to letters.

A function is its set of prime implicants, each a set of demands: the minimal disjunctive normal
form, unique for monotone functions (Quine, "Two theorems about truth functions", 1954). Demands may
imply each other, as `within 2 steps` does `within 3 steps`; it is then unique up to that.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import TypeAlias, TypeVar

from rulec.validation.unprovable import UnprovableError

Function: TypeAlias = frozenset[frozenset[int]]
"""A disjunction of conjunctions of demands, given by their numbers."""

TRUE: Function = frozenset({frozenset()})
FALSE: Function = frozenset()

MOST_TERMS = 1 << 10
"""Functions of more conjunctions are beyond this checker."""

MOST_WORK = 1 << 21
"""The greatest number of values combined for one table."""

_First = TypeVar("_First", bound=Hashable)
_Second = TypeVar("_Second", bound=Hashable)
_Result = TypeVar("_Result", bound=Hashable)


class FunctionAlgebra:
    """Conjunction and disjunction of functions; ``implies`` says if one demand implies another."""

    def __init__(self, implies: Callable[[int, int], bool], most_work: int = MOST_WORK) -> None:
        self._implies, self._most_work = implies, most_work
        self._known: dict[tuple[bool, Function, Function], Function] = {}
        self._work = 0

    def both(self, first: Function, second: Function) -> Function:
        """The conjunction."""
        return self._joined(True, first, second)

    def either(self, first: Function, second: Function) -> Function:
        """The disjunction."""
        return self._joined(False, first, second)

    def _joined(self, conjoined: bool, first: Function, second: Function) -> Function:
        neutral, absorbing = (TRUE, FALSE) if conjoined else (FALSE, TRUE)
        if first in (second, absorbing) or second == neutral:
            return first
        if first == neutral or second == absorbing:
            return second
        key = conjoined, first, second
        if key not in self._known:
            terms: Iterable[frozenset[int]] = first | second
            if conjoined:
                self.count(len(first) * len(second))
                terms = {self._reduced(left | right) for left in first for right in second}
            self._known[key] = self._primes(terms)
        return self._known[key]

    def _reduced(self, term: frozenset[int]) -> frozenset[int]:
        """A conjunction without the demands that others in it imply."""
        return frozenset([x for x in term if not any(y != x and self._implies(y, x) for y in term)])

    def _primes(self, terms: Iterable[frozenset[int]]) -> Function:
        ordered = sorted(terms, key=lambda term: (len(term), sorted(term)))
        self.count(len(ordered) ** 2)
        kept: list[frozenset[int]] = []
        for term in ordered:
            if not any(self._follows(other, term) for other in kept):
                kept = [other for other in kept if not self._follows(term, other)]
                kept.append(term)
        if len(kept) > MOST_TERMS:
            raise UnprovableError("its formula's states are too large for this checker")
        return frozenset(kept)

    def _follows(self, weaker: frozenset[int], stronger: frozenset[int]) -> bool:
        return all(any(self._implies(y, x) for y in stronger) for x in weaker)

    def combined(
        self,
        first: dict[_First, int],
        second: dict[_Second, int],
        operation: Callable[[_First, _Second], _Result],
    ) -> dict[_Result, int]:
        """The results of an operation with the letters of each, from those of its operands."""
        self.count(len(first) * len(second))
        result: dict[_Result, int] = {}
        for letter, letters in first.items():
            for other, other_letters in second.items():
                if common := letters & other_letters:
                    value = operation(letter, other)
                    result[value] = result.get(value, 0) | common
        return result

    def count(self, work: int) -> None:
        """Count steps of work. Raises UnprovableError when there are too many."""
        self._work += work
        if self._work > self._most_work:
            raise UnprovableError("it takes more steps than this checker allows for one table")
