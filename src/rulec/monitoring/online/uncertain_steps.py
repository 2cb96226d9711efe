"""Steps of one rule's monitor when states, letters or the past are not all known.

A set of edges stands for everything that completions of the past may have led to.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rulec.automata.outcome_machine import KEPT, VIOLATED, OutcomeMachine, bits_of
from rulec.monitoring.online.four_valued import (
    WORST_FIRST,
    FourValued,
    LetterClass,
    MonitorEdge,
    RunningVerdict,
    edges_between,
    within,
)
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses

MOST_STEPS = 1 << 16
"""How many steps are kept before all are discarded."""


class _Row(dict[LetterClass, "Edge"]):
    __slots__ = ("_steps", "edge")

    edge: Edge

    def __init__(self, steps: UncertainSteps) -> None:
        self._steps = steps

    def __missing__(self, letters: LetterClass) -> Edge:
        after = self[letters] = self._steps.step(self.edge, letters)
        return after


@dataclass(frozen=True, slots=True, eq=False)
class UncertainEdge:
    """Several edges of a monitor: the states that may have been reached, and the verdicts.

    States are left out if their possible future outcomes lie between those of two others; of the
    states from which nothing is kept, one is left. ``successors`` has the edge or edges for each
    class, or set of classes, and is filled on demand.
    """

    states: tuple[int, ...]
    verdict: RunningVerdict
    successors: _Row


Edge: TypeAlias = MonitorEdge | UncertainEdge


class UncertainSteps:
    """The steps of a rule's machine from and to sets of edges, built on demand.

    ``edges`` are the single edges of ``machine``, by state reached and verdict. ``rows`` have for
    each edge the edge or edges for each class, or set of classes, met so far.
    """

    def __init__(
        self, machine: OutcomeMachine, edges: Mapping[tuple[int, FourValued], MonitorEdge]
    ) -> None:
        self._machine = machine
        self.classes = LetterClasses(machine)
        self._single = edges
        self._numbers: dict[int, LetterClass] = {}
        self._sets: list[tuple[int, ...]] = []
        self._edges: dict[tuple[frozenset[int], RunningVerdict], UncertainEdge] = {}
        self.rows = _Rows(self)
        self._n_steps = 0

    def step(self, edge: Edge, letters: LetterClass) -> Edge:
        """The edge or edges after some letters, newly computed and kept in ``rows``."""
        self._n_steps += 1
        if self._n_steps > MOST_STEPS:
            self._n_steps = 0
            # Monitors may still hold edges, but these must not keep the cache alive.
            for known in self._edges.values():
                known.successors.clear()
            self.rows.clear()
            self._edges.clear()
        machine = self._machine
        states = edge.states if isinstance(edge, UncertainEdge) else (edge.state,)
        n_classes = machine.n_classes
        symbols = (letters,) if letters < n_classes else self._sets[letters - n_classes]
        pairs = [(state, symbol) for state in states for symbol in symbols]
        reached = {machine.successors[state][symbol] for state, symbol in pairs}
        verdicts = {self._verdict(state, symbol) for state, symbol in pairs}
        return self.edge(reached, verdicts)

    def edge(self, states: Iterable[int], verdicts: Iterable[FourValued]) -> Edge:
        """The edges to any of these states, with verdicts from the worst to the best of these."""
        # Lost words are kept apart, so that a continuation may leave them out.
        lost = self._machine.lost.intersection(states := frozenset(states))
        members = self._machine.extremes(states - lost) | frozenset(sorted(lost)[:1])
        ranks = sorted(map(WORST_FIRST.index, verdicts))
        verdict = within(WORST_FIRST[ranks[-1]], WORST_FIRST[ranks[0]])
        single = isinstance(verdict, str) and self._single.get((min(members), verdict))
        if len(members) == 1 and single:
            return single
        key = members, verdict
        if key not in self._edges:
            row = _Row(self)
            row.edge = self._edges[key] = UncertainEdge(tuple(sorted(members)), verdict, row)
        return self._edges[key]

    def letter_class(self, mask: int) -> LetterClass | None:
        """The class, or set of classes, given as bits; None if axioms exclude them all."""
        if mask & (mask - 1) == 0:
            return mask.bit_length() - 1 if mask else None
        number = self._numbers.get(mask)
        if number is None:
            number = self._numbers[mask] = self._machine.n_classes + len(self._sets)
            self._sets.append(bits_of(mask))
        return number

    def _verdict(self, state: int, symbol: int) -> FourValued:
        return _four_valued(self._machine, state, symbol)


class _Rows(dict["Edge", "_Row"]):
    __slots__ = ("_steps",)

    def __init__(self, steps: UncertainSteps) -> None:
        self._steps = steps

    def __missing__(self, edge: Edge) -> _Row:
        if isinstance(edge, UncertainEdge):
            row = edge.successors
        else:
            row = _Row(self._steps)
            row.edge = edge
        self[edge] = row
        return row


def cut_edges(
    machine: OutcomeMachine,
) -> tuple[Edge, dict[tuple[int, FourValued], MonitorEdge], UncertainSteps]:
    """The start of a machine for cut words, its edges, and the steps with sets of them."""
    classes = range(machine.n_classes)
    verdicts = [
        [_four_valued(machine, state, symbol) for symbol in classes]
        for state in range(len(machine.successors))
    ]
    rows, edges = edges_between(machine.successors, verdicts)
    before: FourValued = "satisfied" if machine.starts <= machine.safe else "holds so far"
    states = machine.extremes(machine.starts)
    for state in states:
        edges.setdefault((state, before), MonitorEdge(rows[state], state, before))
    steps = UncertainSteps(machine, edges)
    return steps.edge(states, [before]), edges, steps


def _four_valued(machine: OutcomeMachine, state: int, symbol: int) -> FourValued:
    outcome = machine.outputs[state][symbol]
    if outcome == KEPT:
        return "satisfied" if machine.successors[state][symbol] in machine.safe else "holds so far"
    return "violated" if outcome == VIOLATED else "pending"
