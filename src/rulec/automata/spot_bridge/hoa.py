"""Automata as files in the Hanoi Omega-Automata format."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import spot

VERSION: str = spot.version()


def in_hoa(automaton: Any, name: str, remarks: Sequence[str]) -> str:
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
    """Automaton with propositions sorted by name and states in breadth-first order.

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
        for _, condition, edge in sorted(edges, key=lambda one: one[0]):
            if edge.dst not in position:
                position[edge.dst] = len(states)
                states.append(edge.dst)
            ordered.new_edge(position[state], position[edge.dst], condition, edge.acc)
    ordered.set_init_state(0)
    ordered.prop_copy(automaton, spot.twa_prop_set(*[True] * 6))
    return ordered


def _without_comment_signs(text: str) -> str:
    """Put a text on one line, signs of nesting comments split."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").split())
