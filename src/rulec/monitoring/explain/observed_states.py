"""The states that an explanation covers, with what a rule reads and the truth of its parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from rulec.automata.mealy_monitor import MealyMonitor, NumberRead
from rulec.automata.thresholds import bound_in_floats
from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.kleene import Unknown, evaluator_of, weighted_sum
from rulec.logic.semantics import Semantics, steps_to_settle
from rulec.monitoring.explain.margins import Margin, margin_in
from rulec.monitoring.state_view import StateView
from rulec.trace import Value
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.partly_known.temporal_operators import Beyond, BitInstants

if TYPE_CHECKING:
    from rulec.monitoring.explain.nearest_satisfying import Letter

_Known = TypeVar("_Known")


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


def known_value(value: _Known | Unknown) -> _Known:
    """The value, which must be known."""
    assert not isinstance(value, Unknown), "verify has read it"
    return value


@dataclass(frozen=True, slots=True)
class ObservedStates:
    """States of a binding, all of whose values are known.

    ``numbers`` are those in the trace, ``shown`` the indices of the states to show, among them
    ``decisive``. ``given`` has for an index the state of which it is a completion.
    """

    views: Sequence[StateView]
    bound: Mapping[str, str]
    numbers: Sequence[int]
    shown: Sequence[int]
    decisive: int
    given: Callable[[int], StateView]

    def items(self, variables: Sequence[str]) -> tuple[str, ...]:
        """The objects of some variables."""
        return tuple([self.bound[variable] for variable in variables])

    def value(self, name: str, variables: Sequence[str], view: StateView) -> Value:
        """The value of a declaration in one of the states."""
        value = view.value(name, self.items(variables))
        assert not isinstance(value, Unknown), "verify has read it"
        return value

    def truths(self, proposition: ltl.Proposition) -> int:
        """The truth of a proposition in each state, as bits."""
        return bits_of(self._truths(proposition))

    def _truths(self, proposition: ltl.Proposition) -> list[bool]:
        if isinstance(proposition, ltl.Atom):
            name, items = proposition.name, self.items(proposition.arguments)
            wanted = proposition.value or True
            return [view.value(name, items) == wanted for view in self.views]
        evaluate, bound = evaluator_of(proposition), self.bound
        in_floats = bound_in_floats(proposition)
        if in_floats is None:
            return [evaluate(bound, view) is True for view in self.views]
        term, stands = in_floats
        items, truths = self.items(term.arguments), []
        for view in self.views:
            value = view.value(term.name, items)
            own = stands(value) if type(value) is float else evaluate(bound, view) is True
            truths.append(own)
        return truths

    def word(self, machine: MealyMonitor, n_states: int | None = None) -> list[Letter]:
        """The letters, digit by digit, that a machine reads in all states or in the first ones."""
        return [
            tuple(
                [
                    read.digit(known_value(weighted_sum(read.terms, self.bound, view)))
                    if isinstance(read, NumberRead)
                    else read.digit(self.value(read.name, read.variables, view))
                    for read in machine.reads
                ]
            )
            for view in islice(self.views, n_states)
        ]

    @property
    def looked_up(self) -> Sequence[int]:
        """The indices of the states to show, and of those compared with them."""
        return sorted({*self.shown, self.decisive, max(self.decisive - 1, 0)})

    def margins(self, comparison: ltl.Comparison) -> tuple[Margin | None, ...]:
        """The margins of a comparison in the states shown; None for comparisons of counts."""
        if any(isinstance(term, ltl.Count) for _, term in comparison.terms):
            return ()
        return tuple([self.margin(comparison, number) for number in self.shown])

    def margin(self, comparison: ltl.Comparison, index: int) -> Margin | None:
        """The margin of a comparison in one of the states, as far as it is known."""
        margin = margin_in(comparison, self.bound, self.given(index))
        return None if isinstance(margin, Unknown) else margin

    def changes(self, values: Sequence[object] | Mapping[int, object]) -> bool:
        """Whether the decisive state's value differs from the one before."""
        return self.decisive > 0 and values[self.decisive] != values[self.decisive - 1]

    def flips(self, bits: int) -> bool:
        """The same for a truth, with a bit per state."""
        return self.decisive > 0 and (bits >> self.decisive ^ bits >> self.decisive - 1) & 1 == 1
