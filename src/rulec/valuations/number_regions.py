"""Regions of the number line between the limits of comparisons."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl


@dataclass(frozen=True, slots=True)
class NumberRegions:
    """The regions of numbers that comparisons with these ascending ``limits`` distinguish.

    Region 0 is below the first limit, region 1 is the limit itself, and so on.
    """

    limits: tuple[Fraction, ...]

    def region(self, number: Fraction) -> int:
        """The region of a number."""
        below = bisect_left(self.limits, number)
        return 2 * below + (number in self.limits[below : below + 1])


@lru_cache(maxsize=1 << 10)
def number_regions(
    reads: Sequence[Read | NumberRead], facts: Sequence[ltl.Formula]
) -> Mapping[str, NumberRegions]:
    """The regions of each quantity that is compared alone, not in a sum, by reads and axioms."""
    limits: dict[str, set[Fraction]] = {}
    added: set[str] = set()
    for terms, limit in _comparisons(reads, facts):
        for factor, term in terms:
            if isinstance(term, ltl.QuantityTerm):
                limits.setdefault(term.name, set()).add(limit / factor)
                if len(terms) > 1:
                    added.add(term.name)
    return {
        name: NumberRegions(tuple(sorted(own))) for name, own in limits.items() if name not in added
    }


_Comparison = tuple[Sequence[tuple[Fraction, ltl.Term]], Fraction]


def _comparisons(
    reads: Iterable[Read | NumberRead], facts: Iterable[ltl.Formula]
) -> Iterator[_Comparison]:
    """Sums with what they are compared with, including those within counts."""
    formulas = list(facts)
    for read in reads:
        if isinstance(read, NumberRead):
            yield from ((read.terms, threshold.limit) for threshold in read.thresholds)
            formulas += [term.body for _, term in read.terms if isinstance(term, ltl.Count)]
    for formula in formulas:
        yield from ((own.terms, own.limit) for own in comparisons_in(formula))


def comparisons_in(formula: ltl.Formula) -> Iterator[ltl.Comparison]:
    """The comparisons of a formula, including those within counts."""
    for atom in ltl.atoms_of(formula):
        if isinstance(atom, ltl.Comparison):
            yield atom
            for _, term in atom.terms:
                if isinstance(term, ltl.Count):
                    yield from comparisons_in(term.body)
