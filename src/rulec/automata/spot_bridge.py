"""Everything that is asked of Spot; the only file that imports it.

Spot may use unbounded time or memory, or end its process, on a formula whose automaton explodes.
So this module is only ever loaded in a process of its own, see ``spot_worker``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.letters import count_letters, knowledge, letters_with
from rulec.automata.machine import Read
from rulec.automata.tables import DeterministicAutomaton, Edge
from rulec.logic.formula import (
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.past import Memory, definition, remembered
from rulec.logic.printing import in_spot

VERSION: str = spot.version()


class CheckError(Exception):
    """Spot's automaton does not have the formula's language."""


def translate(formula: Formula, reads: tuple[Read, ...]) -> Any:
    """The ``twa_graph`` of ``formula`` over the letters that the vocabulary allows.

    Deterministic and complete, with parity acceptance; its language is that of the formula and of
    ``knowledge(reads)`` holding at every instant, its propositions are the formula's atoms.
    Raises CheckError where Spot got it wrong.
    """
    present, memories = remembered(formula)
    facts = knowledge(reads)
    meant = present
    if facts != Constant(True):
        always = Unary(UnaryOperator.ALWAYS, facts)
        meant = Binary(BinaryOperator.AND, present, always)
    language = spot.formula(in_spot(meant))
    unsettled = [memory for memory in memories if not memory.settled]
    settled = [memory for memory in memories if memory.settled]
    automaton = _guessed(language, unsettled) if unsettled else spot.translate(language, *_SHAPE)
    if settled:
        automaton = _with_memory(automaton, settled)
    _check(automaton, language, memories)
    return automaton


_SHAPE = ("parity", "det", "complete")


def _defined(memories: Iterable[Memory]) -> Any:
    return spot.formula.And([spot.formula(in_spot(definition(one))) for one in memories])


def _guessed(language: Any, memories: Sequence[Memory]) -> Any:
    """The language's automaton without these memories, which the future has a say in.

    What they are is guessed and projected away, which takes a determinisation.
    """
    guessing = spot.translate(spot.formula.And([language, _defined(memories)]), "small")
    projection = spot.remove_ap()
    for memory in memories:
        projection.add_ap(memory.atom.name)
    return spot.postprocess(projection.strip(guessing), *_SHAPE)


def _with_memory(automaton: Any, memories: Sequence[Memory]) -> Any:
    """The automaton beside a register that holds the memories, which are no propositions any more.

    A state is one of the automaton and the memories' values. These and a letter decide both the
    automaton's edge and the next values: so it stays deterministic and complete.
    """
    propositions = automaton.get_dict()
    for one in memories:
        for atom in atoms_of(one.formula):
            automaton.register_ap(str(atom))
    stored = [buddy.bdd_ithvar(automaton.register_ap(one.atom.name)) for one in memories]
    kept = [
        spot.formula_to_bdd(spot.formula(in_spot(one.formula)), propositions, automaton)
        for one in memories
    ]
    product = spot.make_twa_graph(propositions)
    fresh = {one.atom.name for one in memories}
    for proposition in automaton.ap():
        if proposition.ap_name() not in fresh:
            product.register_ap(proposition)
    product.copy_acceptance_of(automaton)
    product.set_init_state(product.new_state())
    first = (automaton.get_init_state_number(), tuple(one.at_first for one in memories))
    numbers = {first: 0}
    reached = [first]
    for state, values in reached:
        source = numbers[state, values]
        register = buddy.bddtrue
        for bit, value in zip(stored, values, strict=True):
            register &= bit if value else -bit
        following = _choices([buddy.bdd_restrict(formula, register) for formula in kept])
        for edge in automaton.out(state):
            letters = buddy.bdd_restrict(edge.cond, register)
            for condition, later in following:
                if (both := letters & condition) == buddy.bddfalse:
                    continue
                target = (edge.dst, later)
                if target not in numbers:
                    numbers[target] = product.new_state()
                    reached.append(target)
                product.new_edge(source, numbers[target], both, edge.acc)
    product.merge_edges()
    return spot.postprocess(product, *_SHAPE)


def _choices(formulas: Sequence[Any]) -> list[tuple[Any, tuple[bool, ...]]]:
    """The values that formulas can have together, each with the condition for it."""
    found: list[tuple[Any, tuple[bool, ...]]] = [(buddy.bddtrue, ())]
    for formula in formulas:
        found = [
            (both, (*values, value))
            for condition, values in found
            for value in (False, True)
            if (both := condition & (formula if value else -formula)) != buddy.bddfalse
        ]
    return found


def _check(automaton: Any, language: Any, memories: Sequence[Memory] = ()) -> None:
    """The automaton meets no word outside the language, and its complement none inside.

    ``language`` may speak of ``memories``, the automaton must not. Every word has one way to choose
    them as they are defined: it is inside if so completed it is in ``language``, else outside.
    """
    fresh = {memory.atom.name for memory in memories}
    defined = _defined(memories)
    outside = spot.translate(spot.formula.And([spot.formula.Not(language), defined]), "BA", "low")
    inside = spot.translate(spot.formula.And([language, defined]), "BA", "low")
    deterministic = bool(spot.is_deterministic(automaton)) and bool(spot.is_complete(automaton))
    if (
        not deterministic
        or not fresh.isdisjoint(ap.ap_name() for ap in automaton.ap())
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
