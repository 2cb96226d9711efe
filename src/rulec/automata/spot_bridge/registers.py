"""Product of an automaton with registers that remember the past."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
from rulec.automata.tables import MOST_EDGES, MOST_STATES, SizeError
from rulec.logic.formula import Formula, atoms_of
from rulec.logic.past_registers import Register

MOST_CHOICES = 200_000
"""The most ways to take an edge, by what the registers hold for a letter and their operands."""

_Bits = tuple[int, ...]
_Sides = tuple[tuple[bool, bool], ...]
"""For each register the values of its left and its right operand."""

_EVERY = ((True, True), (True, False), (False, True), (False, False))


def with_registers(
    automaton: Any, registers: Sequence[Register], spot_formulas: SpotFormulas
) -> Any:
    """The product of the automaton and the registers; the registers' atoms disappear.

    A state combines a state of the automaton and one of each register. These and a letter determine
    the registers' values, by them the automaton's edge, and the registers' next states, so the
    product stays deterministic and complete. After the end of a finite word, and in a state that is
    never left, the past makes no difference, so the registers are reset. Raises SizeError.
    """
    operands = _Operands(automaton, registers, spot_formulas)
    propositions = automaton.get_dict()
    product = spot.make_twa_graph(propositions)
    fresh = {spot_formulas.formula_of(register.atom).ap_name() for register in registers}
    for proposition in automaton.ap():
        if proposition.ap_name() not in fresh:
            product.register_ap(proposition)
    going, over = buddy.bddtrue, buddy.bddfalse
    if spot_formulas.alive is not None:
        going = buddy.bdd_ithvar(product.register_ap(spot_formulas.alive))
        over = -going
    product.copy_acceptance_of(automaton)
    product.set_init_state(product.new_state())
    empty = tuple(register.at_first for register in registers)
    never_left = [_is_never_left(automaton, state) for state in range(automaton.num_states())]
    numbers = {(automaton.get_init_state_number(), empty): 0}
    reached = list(numbers)
    known: dict[tuple[int, _Bits], list[tuple[Any, _Sides | None, int, Any]]] = {}
    n_choices = 0
    for state, values in reached:
        source = numbers[state, values]
        if never_left[state]:
            (edge,) = automaton.out(state)
            product.new_edge(source, source, buddy.bddtrue, edge.acc)
            continue
        # Of what the registers hold, only whether it is due decides on the letters of edges.
        due = tuple([value >> 1 & 1 for value in values])
        if (state, due) not in known:
            choices = [(cube, letters & going, sides) for cube, letters, sides in operands.on(due)]
            known[state, due] = [
                (both, sides, edge.dst, edge.acc)
                for edge in automaton.out(state)
                for cube, letters, sides in (*choices, (operands.nothing, over, None))
                if (both := buddy.bdd_restrict(edge.cond, cube) & letters) != buddy.bddfalse
            ]
            n_choices += len(known[state, due])
            if n_choices > MOST_CHOICES:
                raise SizeError
        after = [
            {sides: register.after(value, *sides) for sides in _EVERY}
            for register, value in zip(registers, values, strict=True)
        ]
        for letters, sides, state_after, marks in known[state, due]:
            later = empty
            if sides is not None and not never_left[state_after]:
                later = tuple([own[side] for own, side in zip(after, sides, strict=True)])
            target = state_after, later
            if target not in numbers:
                numbers[target] = product.new_state()
                reached.append(target)
            product.new_edge(source, numbers[target], letters, marks)
        if len(reached) > MOST_STATES or product.num_edges() > MOST_EDGES:
            raise SizeError
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

    def on(self, due: _Bits) -> list[tuple[Any, Any, _Sides]]:
        """Steps of registers that hold these bits for a letter.

        Each has the registers' values, the letters, and the values of the operands.
        """
        result: list[tuple[Any, Any, _Sides]] = [(buddy.bddtrue, buddy.bddtrue, ())]
        for is_due, (register, *operands, atom) in zip(due, self._registers, strict=True):
            held = {own: atom if register.after(is_due << 1, *own) & 1 else -atom for own in _EVERY}
            result = [
                (cube & held[own], both, (*sides, own))
                for cube, letters, sides in result
                for left, right in [[buddy.bdd_restrict(side, cube) for side in operands]]
                for own in _EVERY
                if (both := letters & (left if own[0] else -left) & (right if own[1] else -right))
                != buddy.bddfalse
            ]
        return result
