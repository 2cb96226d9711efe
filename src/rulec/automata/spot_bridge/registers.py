"""Product of an automaton with registers that remember the past."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
from rulec.logic.formula import Formula, atoms_of
from rulec.logic.past_registers import Register

_Values = tuple[int, ...]


def with_registers(
    automaton: Any, registers: Sequence[Register], spot_formulas: SpotFormulas
) -> Any:
    """The product of the automaton and the registers; the registers' atoms disappear.

    A state combines a state of the automaton and one of each register. These and a letter determine
    the registers' values, by them the automaton's edge, and the registers' next states, so the
    product stays deterministic and complete. After the end of a finite word, and in a state that is
    never left, the past makes no difference, so the registers are reset.
    """
    operands = _Operands(automaton, registers, spot_formulas)
    propositions = automaton.get_dict()
    product = spot.make_twa_graph(propositions)
    fresh = {spot_formulas.formula_of(register.atom).ap_name() for register in registers}
    for proposition in automaton.ap():
        if proposition.ap_name() not in fresh:
            product.register_ap(proposition)
    going = buddy.bddtrue
    if spot_formulas.alive is not None:
        going = buddy.bdd_ithvar(product.register_ap(spot_formulas.alive))
    product.copy_acceptance_of(automaton)
    product.set_init_state(product.new_state())
    empty = tuple(register.at_first for register in registers)
    never_left = [_is_never_left(automaton, state) for state in range(automaton.num_states())]
    numbers = {(automaton.get_init_state_number(), empty): 0}
    reached = list(numbers)
    over = (-going, operands.nothing, empty)
    for state, values in reached:
        source = numbers[state, values]
        if never_left[state]:
            (edge,) = automaton.out(state)
            product.new_edge(source, source, buddy.bddtrue, edge.acc)
            continue
        choices = [(letters & going, cube, later) for letters, cube, later in operands.on(values)]
        for edge in automaton.out(state):
            for letters, cube, later in [*choices, over]:
                both = buddy.bdd_restrict(edge.cond, cube) & letters
                if both == buddy.bddfalse:
                    continue
                target = (edge.dst, empty if never_left[edge.dst] else later)
                if target not in numbers:
                    numbers[target] = product.new_state()
                    reached.append(target)
                product.new_edge(source, numbers[target], both, edge.acc)
    product.merge_edges()
    return product


def _is_never_left(automaton: Any, state: int) -> bool:
    """Whether a state has only one edge, a loop for all letters."""
    edges = list(automaton.out(state))
    return len(edges) == 1 and edges[0].dst == state and edges[0].cond == buddy.bddtrue


class _Operands:
    """The registers' values as a function of letters."""

    def __init__(
        self, automaton: Any, registers: Sequence[Register], spot_formulas: SpotFormulas
    ) -> None:
        def condition(formula: Formula) -> Any:
            for atom in atoms_of(formula):
                automaton.register_ap(spot_formulas.formula_of(atom).ap_name())
            return spot.formula_to_bdd(
                spot_formulas.formula_of(formula), automaton.get_dict(), automaton
            )

        self._registers = [
            (register, *map(condition, (register.left, register.right, register.atom)))
            for register in registers
        ]
        self.nothing = buddy.bddtrue
        """The condition on the registers' atoms that none of them is true."""
        for *_, atom in self._registers:
            self.nothing &= -atom
        self._known: dict[_Values, list[tuple[Any, Any, _Values]]] = {}

    def on(self, values: _Values) -> list[tuple[Any, Any, _Values]]:
        """Steps of registers: triples of letters, present values and next states."""
        if values not in self._known:
            result: list[tuple[Any, Any, _Values]] = [(buddy.bddtrue, buddy.bddtrue, ())]
            for value, (register, left, right, atom) in zip(values, self._registers, strict=True):
                result = [
                    (letters & more, cube & (atom if later & 1 else -atom), (*others, later))
                    for letters, cube, others in result
                    for later, more in _steps(
                        register, value, *(buddy.bdd_restrict(side, cube) for side in (left, right))
                    ).items()
                    if (letters & more) != buddy.bddfalse
                ]
            self._known[values] = result
        return self._known[values]


def _steps(register: Register, value: int, left: Any, right: Any) -> dict[int, Any]:
    """The register's next states, each with the letters that lead there."""
    steps: dict[int, Any] = {}
    for is_left, when_left in ((True, left), (False, -left)):
        for is_right, when_right in ((True, right), (False, -right)):
            later = register.after(value, is_left, is_right)
            steps[later] = steps.get(later, buddy.bddfalse) | (when_left & when_right)
    return steps
