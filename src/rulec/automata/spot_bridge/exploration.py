"""Automata as what tables are made of: edges over sets of letters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.alphabet import count_letters, letters_with
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.spot_bridge.translation import Translation
from rulec.automata.tables import DeterministicAutomaton, TableEdge


def explore(translation: Translation, reads: Sequence[Read | NumberRead]) -> DeterministicAutomaton:
    """Automaton with the letters of ``reads``; colours and letters as bits."""
    automaton = translation.automaton
    sets = {
        translation.names[one]: letters
        for one, letters in letters_with(reads, translation.names).items()
    }
    everything = (1 << count_letters(reads)) - 1
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
