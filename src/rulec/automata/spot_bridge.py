"""Everything that is asked of Spot; the only file that imports it.

Spot may use unbounded time or memory, or end its process, on a formula whose automaton explodes.
So this module is only ever loaded in a process of its own, see ``spot_worker``.
"""

from __future__ import annotations

from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.letters import count_letters, knowledge, letters_with
from rulec.automata.machine import Read
from rulec.automata.tables import DeterministicAutomaton, Edge
from rulec.logic.formula import Binary, BinaryOperator, Constant, Formula, Unary, UnaryOperator
from rulec.logic.printing import in_spot

VERSION: str = spot.version()


class CheckError(Exception):
    """Spot's automaton does not have the formula's language."""


def translate(formula: Formula, reads: tuple[Read, ...]) -> Any:
    """The ``twa_graph`` of ``formula`` over the letters that the vocabulary allows.

    Deterministic and complete, with parity acceptance; its language is that of the formula and of
    ``knowledge(reads)`` holding at every instant. Raises CheckError where Spot got it wrong.
    """
    facts = knowledge(reads)
    meant = formula
    if facts != Constant(True):
        always = Unary(UnaryOperator.ALWAYS, facts)
        meant = Binary(BinaryOperator.AND, formula, always)
    language = spot.formula(in_spot(meant))
    automaton = spot.translate(language, "parity", "det", "complete")
    _check(automaton, language)
    return automaton


def _check(automaton: Any, language: Any) -> None:
    """The automaton meets no word outside the language, and its complement none inside."""
    outside = spot.translate(spot.formula.Not(language), "BA", "low")
    inside = spot.translate(language, "BA", "low")
    deterministic = bool(spot.is_deterministic(automaton)) and bool(spot.is_complete(automaton))
    if (
        not deterministic
        or automaton.intersects(outside)
        or spot.dualize(automaton).intersects(inside)
    ):
        raise CheckError


def in_hoa(automaton: Any, name: str, remarks: tuple[str, ...]) -> str:
    """The automaton in the Hanoi Omega-Automata format, version 1.

    ``remarks`` become comments: the format has headers of one's own too, but not every tool that
    reads it skips those.
    """
    ordered = _ordered(automaton)
    ordered.set_name(name)
    first, *rest = ordered.to_str("hoa").splitlines()
    comments = [f"/* {_without_comment_signs(remark)} */" for remark in remarks]
    return "\n".join([first, *comments, *rest]) + "\n"


def _ordered(automaton: Any) -> Any:
    """The same automaton with its propositions by name and its states in breadth-first order.

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
    for state in states:
        edges = []
        for edge in automaton.out(state):
            meaning = spot.bdd_to_formula(edge.cond, known)
            condition = spot.formula_to_bdd(meaning, fresh, ordered)
            edges.append((spot.bdd_format_formula(fresh, condition), condition, edge))
        for _, condition, edge in sorted(edges, key=lambda one: one[0]):
            if edge.dst not in position:
                position[edge.dst] = len(states)
                states.append(edge.dst)
            ordered.new_edge(position[state], position[edge.dst], condition, edge.acc)
    ordered.set_init_state(0)
    ordered.prop_copy(automaton, spot.twa_prop_set(*[True] * 6))
    return ordered


def _without_comment_signs(text: str) -> str:
    """On one line, and with nothing that would open or close a comment: they nest."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").split())


def explore(automaton: Any, reads: tuple[Read, ...]) -> DeterministicAutomaton:
    """The automaton's edges over the letters of ``reads``; colours and letters as bits."""
    sets = {str(atom): letters for atom, letters in letters_with(reads).items()}
    variables = {automaton.register_ap(ap): sets[ap.ap_name()] for ap in automaton.ap()}
    everything = (1 << count_letters(reads)) - 1
    seen: dict[int, int] = {buddy.bddfalse.id(): 0, buddy.bddtrue.id(): everything}

    def letters_on(condition: Any) -> int:
        found = seen.get(condition.id())
        if found is None:
            true = variables[buddy.bdd_var(condition)]
            high = letters_on(buddy.bdd_high(condition))
            low = letters_on(buddy.bdd_low(condition))
            found = seen[condition.id()] = (true & high) | (everything & ~true & low)
        return found

    edges = tuple(
        tuple(
            Edge(letters, edge.dst, sum(1 << colour for colour in edge.acc.sets()))
            for edge in automaton.out(state)
            if (letters := letters_on(edge.cond))
        )
        for state in range(automaton.num_states())
    )
    acceptance = automaton.acc()

    def accepts(colours: int) -> bool:
        marks = [index for index in range(acceptance.num_sets()) if colours >> index & 1]
        return bool(acceptance.accepting(spot.mark_t(marks)))

    return DeterministicAutomaton(edges, automaton.get_init_state_number(), accepts)
