"""Spot's automata as HOA files, and as edges for tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.spot_bridge.translation import Translation
from rulec.automata.tables import DeterministicAutomaton, TableEdge
from rulec.logic.formula import Proposition

VERSION: str = spot.version()


def in_hoa(automaton: Any, name: str, comments: Sequence[str]) -> str:
    """The automaton in the Hanoi Omega-Automata format, version 1.

    What is remarked are comments: the format also has custom headers, but not every tool skips
    those.
    """
    ordered = _ordered(automaton)
    ordered.set_name(name)
    first, *rest = ordered.to_str("hoa").splitlines()
    return "\n".join([first, *comments, *rest]) + "\n"


def _ordered(automaton: Any) -> Any:
    """The automaton with propositions sorted by name and states in breadth-first order.

    Spot's own order depends on what it has translated before; a rule's file should not.
    """
    known = automaton.get_dict()
    fresh = spot.make_bdd_dict()
    ordered = spot.make_twa_graph(fresh)
    for name in sorted(ap.ap_name() for ap in automaton.ap()):
        ordered.register_ap(spot.formula.ap(name))
    ordered.copy_acceptance_of(automaton)
    ordered.new_states(automaton.num_states())
    states = [automaton.get_init_state_number()]
    position = {states[0]: 0}
    conditions: dict[int, tuple[str, Any]] = {}
    for state in states:
        edges = []
        for edge in automaton.out(state):
            if edge.cond.id() not in conditions:
                meaning = spot.bdd_to_formula(edge.cond, known)
                condition = spot.formula_to_bdd(meaning, fresh, ordered)
                text = spot.bdd_format_formula(fresh, condition)
                conditions[edge.cond.id()] = (text, condition)
            edges.append((*conditions[edge.cond.id()], edge))
        for _, condition, edge in sorted(edges, key=lambda pair: pair[0]):
            if edge.dst not in position:
                position[edge.dst] = len(states)
                states.append(edge.dst)
            ordered.new_edge(position[state], position[edge.dst], condition, edge.acc)
    ordered.set_init_state(0)
    ordered.prop_copy(automaton, spot.twa_prop_set(*[True] * 6))
    return ordered


def explore(
    translation: Translation, letters_with: Mapping[Proposition, int], n_letters: int
) -> DeterministicAutomaton:
    """The automaton over letters, of which ``letters_with`` has those of each proposition.

    Colours and letters are bit sets.
    """
    automaton = translation.automaton
    sets = {name: letters_with[atom] for atom, name in translation.names.items()}
    everything = (1 << n_letters) - 1
    if translation.alive is not None:
        sets[translation.alive] = everything
    variables = {automaton.register_ap(ap): sets[ap.ap_name()] for ap in automaton.ap()}
    seen: dict[int, int] = {buddy.bddfalse.id(): 0, buddy.bddtrue.id(): everything}

    def letters_on(condition: Any) -> int:
        result = seen.get(condition.id())
        if result is None:
            true = variables[buddy.bdd_var(condition)]
            high = letters_on(buddy.bdd_high(condition))
            low = letters_on(buddy.bdd_low(condition))
            result = seen[condition.id()] = (true & high) | (everything & ~true & low)
        return result

    edges = tuple(
        tuple(
            TableEdge(letters, edge.dst, _bits(edge.acc))
            for edge in automaton.out(state)
            if (letters := letters_on(edge.cond))
        )
        for state in range(automaton.num_states())
    )
    acceptance = automaton.acc()

    def accepts(colours: int) -> bool:
        marks = [index for index in range(acceptance.num_sets()) if colours >> index & 1]
        return bool(acceptance.accepting(spot.mark_t(marks)))

    initial = automaton.get_init_state_number()
    after = None if translation.alive is None else _after_the_end(automaton)
    return DeterministicAutomaton(edges, initial, accepts, after)


def _bits(colours: Any) -> int:
    return sum(1 << colour for colour in colours.sets())


def _after_the_end(automaton: Any) -> tuple[tuple[int, int], ...]:
    """Successor and colours of each state at the end of a word."""
    nothing = buddy.bddtrue
    for ap in automaton.ap():
        nothing &= -buddy.bdd_ithvar(automaton.register_ap(ap))
    return tuple(
        next(
            (edge.dst, _bits(edge.acc))
            for edge in automaton.out(state)
            if (edge.cond & nothing) != buddy.bddfalse
        )
        for state in range(automaton.num_states())
    )
