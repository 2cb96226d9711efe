"""Proof of a rule's HOA text against the formula, for every trace.

The automaton judges infinite words. The word of a trace repeats its last state for ever or, under
`finite`, makes an extra proposition false after it. For such words both sides are compared, in all
pairs of states that a trace leads to; other infinite words do not matter.
"""

from __future__ import annotations

import re
from typing import Any

from rulec.validation.formula_words import atoms_in, formula_words
from rulec.validation.hoa_text import HoaAutomaton, read_hoa
from rulec.validation.letter_sets import Letters, told_apart
from rulec.validation.table_proof import FormulaMachine, led_to
from rulec.validation.unprovable import require

MOST_STEPS = 1 << 20
"""The greatest number of edges examined, over all classes of letters."""

_ALIVE = re.compile(r"alive(?: \([0-9]+\))?")


def prove_hoa(
    machine: FormulaMachine, text: str, tree: Any, letters: Letters, *, ends: bool
) -> None:
    """Raise UnprovableError unless an automaton accepts exactly the traces its formula keeps.

    ``ends`` if nothing follows a word; the automaton then has each letter twice, the upper half for
    states in which the trace goes on.
    """
    size, possible = letters.count, machine.possible
    truth = {formula_words(atom): letters.of(atom) for atom in atoms_in(tree)}
    going_on = ((1 << size) - 1) << size
    unknown: list[str] = []

    def letters_of(name: str) -> int:
        if name in truth:
            return truth[name] << size | truth[name] if ends else truth[name]
        unknown.append(name)
        return going_on

    every = possible << size | possible if ends else possible
    automaton = read_hoa(text, letters_of, (1 << (size << ends)) - 1)
    fits = len(unknown) <= ends and all(map(_ALIVE.fullmatch, unknown))
    require(fits, "its HOA text has other propositions than its formula")
    for row in automaton.edges:
        met = 0
        for edge in row:
            require(not met & edge.letters & every, "its HOA text is not deterministic")
            met |= edge.letters
        require(not every & ~met, "its HOA text has no edge for a possible letter")
    accepted = _over(automaton, possible) if ends else _repeated(automaton, possible)
    shift = size if ends else 0
    first = machine.progression.start, automaton.start
    seen = {first}
    for state, place in (waiting := [first]):
        for move in machine.moves(state):
            for edge in automaton.edges[place]:
                common = move.letters & (edge.letters >> shift)
                if not common:
                    continue
                right = accepted[edge.target] if ends else accepted[place]
                judged = possible if move.kept else 0
                same = not common & (right ^ judged)
                require(same, "its HOA text judges some trace differently from its tree")
                target = move.target, edge.target
                if target not in seen:
                    require(len(seen) < MOST_STEPS, "its HOA text is too large for this checker")
                    seen.add(target)
                    waiting.append(target)


def _repeated(automaton: HoaAutomaton, possible: int) -> list[int]:
    """For each state, the letters that are accepted if repeated for ever from there."""
    accepted = [0] * len(automaton.edges)
    steps = 0
    labels = {edge.letters for row in automaton.edges for edge in row}
    most = MOST_STEPS // len(accepted)
    for letters in told_apart(possible, labels, most, "its HOA text is too large for this checker"):
        steps += len(accepted)
        require(steps <= MOST_STEPS, "its HOA text is too large for this checker")
        own = [next(edge for edge in row if edge.letters & letters) for row in automaton.edges]
        verdicts: dict[int, bool] = {}
        for start in range(len(own)):
            path: dict[int, None] = {}
            here = start
            while here not in verdicts and here not in path:
                path[here] = None
                here = own[here].target
            if here not in verdicts:
                places = list(path)
                circle = places[places.index(here) :]
                marks = frozenset().union(*[own[place].marks for place in circle])
                verdicts[here] = automaton.accepts(marks)
            verdicts.update(dict.fromkeys(path, verdicts[here]))
        for state, verdict in verdicts.items():
            accepted[state] |= letters if verdict else 0
    return accepted


def _over(automaton: HoaAutomaton, possible: int) -> list[int]:
    """For each state, all letters if a trace that ended on entering it is accepted, else none.

    After the end all words must be judged alike: on all cycles, the edges have the same marks.
    """
    dead = [[edge for edge in row if edge.letters & possible] for row in automaton.edges]
    result: list[int] = []
    for start in range(len(dead)):
        seen = {start}
        for state in (waiting := [start]):
            for edge in dead[state]:
                if edge.target not in seen:
                    seen.add(edge.target)
                    waiting.append(edge.target)
        graph = {state: {edge.target for edge in dead[state]} for state in seen}
        # Only of edges on cycles; others are passed once.
        marks = {
            edge.marks
            for state in seen
            for edge in dead[state]
            if edge.target in led_to({state}, graph)
        }
        verdicts = {automaton.accepts(own) for own in marks}
        require(len(marks) == 1, "its HOA text distinguishes words after the end of a trace")
        result.append(possible if verdicts == {True} else 0)
    return result
