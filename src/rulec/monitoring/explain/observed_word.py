"""The truth of a formula's propositions in observed states, and of all its parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.semantics import Semantics, steps_to_settle
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.partly_known.temporal_operators import Beyond, BitInstants


def bits_of(flags: Sequence[bool]) -> int:
    """Flags as bits, the first one the lowest."""
    return int("".join(["1" if flag else "0" for flag in reversed(flags)]) or "0", 2)


@dataclass(frozen=True, slots=True)
class ObservedWord:
    """The truths of propositions in ``n_states`` states, as bits; those beyond mean nothing."""

    truths: Mapping[ltl.Proposition, int]
    n_states: int
    semantics: Semantics

    def up_to(self, last: int, n_states: int) -> ObservedWord:
        """The word that ends where states do, with nothing true behind a ``last`` one."""
        inside = (2 << last) - 1
        truths = {part: bits & inside for part, bits in self.truths.items()}
        return ObservedWord(truths, n_states, "finite")

    def holds(self, formula: ltl.Formula) -> bool:
        """Whether a formula, with bounds in steps, holds in the first state."""
        return fold(formula, self._algebra(self._n_settled(formula))).sure & 1 == 1

    def parts(self, formula: ltl.Formula) -> dict[ltl.Formula, list[bool]]:
        """The truth of all parts by state, operands first, beyond the word until they settle."""
        parts: dict[ltl.Formula, Truth[int]] = {}
        n_states = self._n_settled(formula)
        fold(formula, self._algebra(n_states), parts)
        inside = (1 << n_states) - 1
        return {
            part: [bit == "1" for bit in reversed(f"{truth.sure & inside:0{n_states}b}")]
            for part, truth in parts.items()
        }

    def _n_settled(self, formula: ltl.Formula) -> int:
        """The number of states until nothing changes any more."""
        settles = 0 if self.semantics == "finite" else steps_to_settle(formula)
        return self.n_states + settles

    def _algebra(self, n_states: int) -> Algebra[Truth[int]]:
        """The meaning of formulas in the word, with its last state repeated."""
        inside = (1 << self.n_states) - 1
        beyond = (1 << n_states) - 1 ^ inside

        def proposition(part: ltl.Proposition) -> Truth[int]:
            bits = self.truths[part] & inside
            return Truth.known(bits | beyond if bits >> self.n_states - 1 else bits)

        ends: Beyond = "over" if self.semantics == "finite" else "goes on"
        return BitInstants(n_states, ends).algebra(proposition)
