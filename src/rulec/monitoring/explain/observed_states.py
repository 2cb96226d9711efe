"""The states that an explanation covers, with the values that a rule reads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from rulec.automata.mealy_monitor import MealyMonitor, NumberRead
from rulec.automata.thresholds import bound_in_floats
from rulec.logic import formula as ltl
from rulec.logic.kleene import Unknown, evaluator_of, weighted_sum
from rulec.monitoring.explain.margins import Margin, margin_in
from rulec.monitoring.explain.observed_word import bits_of
from rulec.monitoring.state_view import StateView
from rulec.trace import Value

if TYPE_CHECKING:
    from rulec.monitoring.explain.nearest_satisfying import Letter

_Known = TypeVar("_Known")


def known_value(value: _Known | Unknown) -> _Known:
    """The value, which must be known."""
    assert not isinstance(value, Unknown), "verify has read it"
    return value


@dataclass(frozen=True, slots=True)
class ObservedStates:
    """States of a binding, all of whose values are known.

    ``shown`` are the indices of the states to show, among them ``decisive``. ``given`` has for an
    index the state of which it is a completion.
    """

    views: Sequence[StateView]
    bound: Mapping[str, str]
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
