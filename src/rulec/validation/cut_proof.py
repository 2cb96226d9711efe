"""Proof of a table for cut traces against the formula, starting from every possible past."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rulec.validation.formula_progression import DemandState
from rulec.validation.letter_sets import Letters, told_apart
from rulec.validation.table_proof import MOST_STATES, ClaimedTable, FormulaMachine, led_to
from rulec.validation.unprovable import require

_KEPT, _PENDING, _VIOLATED = range(3)
MOST_ATOMS = 1 << 12
"""Greatest number of sets of letters that the formula and the table may distinguish."""


def prove_cut_table(
    machine: FormulaMachine, entry: Mapping[str, Any], letters: Letters, *, goes_on: bool
) -> None:
    """Raise UnprovableError unless a table for cut traces gives every word its formula's outcome.

    What came before is unknown: a run begins in every state that some past leads to and, for a rule
    that ``goes_on``, also in every state reachable from there while the rule is not violated.
    Moore's partition refinement groups the states of both sides that no word distinguishes; the
    states where runs begin must be in the same groups.
    """
    table = ClaimedTable.read(entry, "outcomes", letters, machine.possible)
    starts = entry["starts"]
    known = len(starts) > 0 and all(
        type(s) is int and 0 <= s < len(table.following) for s in starts
    )
    require(known, "its table for cut traces has no valid start states")
    own_starts = [DemandState(machine.progression.start.demand, past) for past in _pasts(machine)]
    states = list(dict.fromkeys(own_starts))
    seen = set(states)
    for state in states:
        for move in machine.moves(state):
            if move.target not in seen:
                seen.add(move.target)
                states.append(move.target)
    graph = {state: {move.target for move in machine.moves(state)} for state in states}
    kept = {state for state in states if any(move.kept for move in machine.moves(state))}
    alive = led_to(kept, graph)
    if goes_on:
        for state in own_starts:
            own_starts += [
                move.target
                for move in machine.moves(state)
                if (move.kept or move.target in alive) and move.target not in own_starts
            ]
    atoms = _atoms(machine, states, table)
    places = {state: place for place, state in enumerate(states)}
    targets, outcomes = [], []
    for state in states:
        row = [next(move for move in machine.moves(state) if move.letters & atom) for atom in atoms]
        targets.append([places[move.target] for move in row])
        outcomes.append(
            [
                _VIOLATED
                if not move.kept and move.target not in alive
                else _KEPT
                if machine.progression.holds_at_the_end(move.target)
                else _PENDING
                for move in row
            ]
        )
    symbols = [
        next(symbol for symbol, members in enumerate(table.classes) if members & atom)
        for atom in atoms
    ]
    for following, outputs in zip(table.following, table.outputs, strict=True):
        targets.append([len(states) + following[symbol] for symbol in symbols])
        outcomes.append([outputs[symbol] for symbol in symbols])
    blocks = _blocks(targets, outcomes)
    here = {blocks[places[state]] for state in own_starts}
    there = {blocks[len(states) + start] for start in starts}
    require(here == there, "its table for cut traces has other outcomes than its formula")


def _pasts(machine: FormulaMachine) -> list[Any]:
    """Everything that past parts can remember, whatever happened before the first state."""
    memories = dict.fromkeys([machine.progression.start.memory])
    for memory in (waiting := list(memories)):
        for following in machine.progression.memories(memory):
            if following not in memories:
                memories[following] = None
                waiting.append(following)
        require(len(memories) <= MOST_STATES, "its formula has too many pasts for this checker")
    return waiting


def _atoms(
    machine: FormulaMachine, states: Sequence[DemandState], table: ClaimedTable
) -> list[int]:
    """The coarsest partition of letters that no move or class cuts."""
    sets = {move.letters for state in states for move in machine.moves(state)}
    reason = "its formula distinguishes too many letters"
    return told_apart(machine.possible, sorted(sets | set(table.classes)), MOST_ATOMS, reason)


def _blocks(targets: Sequence[Sequence[int]], outcomes: Sequence[Sequence[int]]) -> list[int]:
    """For each state the block of states that no word distinguishes from it."""
    blocks = _numbered([tuple(row) for row in outcomes])
    while True:
        finer = _numbered(
            [
                (block, *[blocks[target] for target in row])
                for block, row in zip(blocks, targets, strict=True)
            ]
        )
        if max(finer) == max(blocks):
            return finer
        blocks = finer


def _numbered(keys: Sequence[tuple[int, ...]]) -> list[int]:
    numbers: dict[tuple[int, ...], int] = {}
    return [numbers.setdefault(key, len(numbers)) for key in keys]
