"""Deterministic automata of bounded formulas, by formula progression.

A state represents what the rest of the word must satisfy (formula progression, Bacchus and Kabanza,
"Using temporal logic to control search in a forward chaining planner", 1996). Equivalent states are
merged. With bounds it matters that a shorter until implies a longer one: of all the pending
`eventually[<= 100 steps] p` only the most urgent one counts.
"""

from __future__ import annotations

from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.spot_bridge.obligations import Obligations
from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
from rulec.automata.tables import MOST_EDGES, MOST_STATES, SizeError
from rulec.logic.formula import Formula


class Progression:
    """The automaton of a formula without past operators.

    ``is_decided``: on infinite words, too, a prefix decides every rejected word, or every accepted
    one: the formula is a safety or co-safety formula, judged by its operators.
    """

    def __init__(self, formula: Formula, spot_formulas: SpotFormulas) -> None:
        self._of = Obligations(formula, spot_formulas)
        self.is_decided = self._of.is_safety or self._of.is_cosafety
        self._composed: dict[int, tuple[Any, Any]] = {}

    def _replaced(self, state: Any) -> Any:
        if state == buddy.bddtrue or state == buddy.bddfalse:
            return state
        result = self._composed.get(state.id())
        if result is None:
            high = self._replaced(buddy.bdd_high(state))
            low = self._replaced(buddy.bdd_low(state))
            unfolded = self._of.unfolded[buddy.bdd_var(state)]
            result = state, buddy.bdd_ite(unfolded, high, low)
            # Holding the first BDD keeps its number from being reused.
            self._composed[state.id()] = result
        return result[1]

    def _split(self, left: Any, known: dict[int, Any]) -> dict[int, tuple[Any, Any]]:
        """For each target: (letters, target). Letters' variables are above those of obligations."""
        if left == buddy.bddtrue or left == buddy.bddfalse:
            return {left.id(): (buddy.bddtrue, left)}
        variable = buddy.bdd_var(left)
        if variable in self._of.unfolded:
            return {left.id(): (buddy.bddtrue, left)}
        if left.id() not in known:
            letter = buddy.bdd_ithvar(variable)
            results: dict[int, tuple[Any, Any]] = {}
            for side, branch in ((letter, buddy.bdd_high(left)), (-letter, buddy.bdd_low(left))):
                for key, (letters, target) in self._split(branch, known).items():
                    before = results[key][0] if key in results else buddy.bddfalse
                    results[key] = before | (side & letters), target
            known[left.id()] = results
        result: dict[int, tuple[Any, Any]] = known[left.id()]
        return result

    def _table(self) -> tuple[list[Any], list[list[tuple[Any, int]]]]:
        """The obligations of each state, and its edges as (letters, target).

        State 0 is the one before the word; nothing leads back to it. Raises SizeError.
        """
        states: list[Any] = [None]
        n_edges = 0
        numbers: dict[int, int] = {}
        table = []
        for state in states:
            left = self._of.first if state is None else self._replaced(state)
            # Under the known implications, equivalent states become equal.
            left = buddy.bdd_constrain(left, self._of.known)
            edges = []
            for letters, target in self._split(left, {}).values():
                if target.id() not in numbers:
                    numbers[target.id()] = len(states)
                    states.append(target)
                edges.append((letters, numbers[target.id()]))
            table.append(edges)
            n_edges += len(edges)
            if len(states) > MOST_STATES or n_edges > MOST_EDGES:
                raise SizeError
        return states, table

    def infinite(self) -> Any:
        """The deterministic, complete, weak Büchi automaton of a decided formula."""
        states, table = self._table()
        automaton = self._empty(len(states))
        for number, (state, edges) in enumerate(zip(states, table, strict=True)):
            # Buddy cannot compare a BDD with None.
            marked = state is not None and (
                state != buddy.bddfalse if self._of.is_safety else state == buddy.bddtrue
            )
            for letters, target in edges:
                automaton.new_edge(number, target, letters, _MARKED if marked else _PLAIN)
        return automaton

    def finite(self, alive: str) -> Any:
        """The automaton of a formula on finite words: infinite words where ``alive`` becomes false.

        What comes after a word's end does not matter, except that ``alive`` stays false.
        """
        states, table = self._table()
        lost, ended = len(states), len(states) + 1
        automaton = self._empty(len(states) + 2)
        going = buddy.bdd_ithvar(automaton.register_ap(alive))
        for number, (state, edges) in enumerate(zip(states, table, strict=True)):
            for letters, target in edges:
                automaton.new_edge(number, target, letters & going, _PLAIN)
            # Before the first letter there is no word yet.
            well = state is not None and self._of.ends_well(state)
            automaton.new_edge(number, ended if well else lost, -going, _PLAIN)
        automaton.new_edge(lost, lost, buddy.bddtrue, _PLAIN)
        automaton.new_edge(ended, ended, -going, _MARKED)
        automaton.new_edge(ended, lost, going, _MARKED)
        return automaton

    def _empty(self, n_states: int) -> Any:
        automaton = spot.make_twa_graph(self._of.propositions.get_dict())
        for name in self._of.names.values():
            automaton.register_ap(name)
        automaton.set_buchi()
        automaton.new_states(n_states)
        automaton.set_init_state(0)
        automaton.prop_universal(True)
        automaton.prop_weak(True)
        automaton.prop_state_acc(True)
        return automaton


_PLAIN, _MARKED = spot.mark_t([]), spot.mark_t([0])
