"""Steps of one rule's monitor, on sets of a machine's states and of letter classes.

A known state or letter is a set of one. A set stands for everything that completions of the past,
and of what is unknown now, may lead to.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from rulec.automata.outcome_machine import KEPT, VIOLATED, OutcomeMachine, bits_of
from rulec.monitoring.online.four_valued import (
    WORST_FIRST,
    ClassSet,
    FourValued,
    RunningVerdict,
    within,
)
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses

MOST_STEPS = 1 << 16
"""How many steps are kept before all are discarded."""


class Edge(dict[ClassSet, "Edge"]):
    """An edge of a monitor: the states that may have been reached, and the verdicts.

    States are left out if their possible future outcomes lie between those of two others; of the
    states from which nothing is kept, one is left. It maps the classes that come next to the edge
    that follows, which is found on demand.
    """

    __slots__ = ("_steps", "states", "verdict")
    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, steps: RuleSteps, states: tuple[int, ...], verdict: RunningVerdict) -> None:
        self._steps, self.states, self.verdict = steps, states, verdict

    def __missing__(self, classes: ClassSet) -> Edge:
        after = self._steps.after(self, classes)
        self[classes] = after
        return after

    @property
    def is_known(self) -> bool:
        """Whether it is a single edge of the machine."""
        return len(self.states) == 1 and isinstance(self.verdict, str)

    @property
    def ends(self) -> tuple[object, RunningVerdict]:
        """Equal for edges after which everything is the same."""
        return self.states, self.verdict


class RuleSteps:
    """The steps of a rule's machine, built on demand.

    ``start`` is the edge before the first letter, ``classes`` are those of possible letters.
    """

    def __init__(self, machine: OutcomeMachine) -> None:
        self._machine = machine
        self.classes = LetterClasses(machine)
        self._edges: dict[tuple[frozenset[int], RunningVerdict], Edge] = {}
        self._n_steps = 0
        self._before: FourValued = "satisfied" if machine.starts <= machine.safe else "holds so far"
        self.start = self.edge(machine.starts, [self._before])

    def after(self, edge: Edge, classes: ClassSet) -> Edge:
        """The edge after a letter of any of these classes, newly computed."""
        self._n_steps += 1
        if self._n_steps > MOST_STEPS:
            self._n_steps = 0
            # Monitors may still hold edges, but these must not keep the cache alive.
            for known in self._edges.values():
                known.clear()
            self._edges.clear()
        pairs = [(state, symbol) for state in edge.states for symbol in bits_of(classes)]
        reached = {self._machine.successors[state][symbol] for state, symbol in pairs}
        return self.edge(reached, {self._verdict(state, symbol) for state, symbol in pairs})

    def edge(self, states: Iterable[int], verdicts: Iterable[FourValued]) -> Edge:
        """The edge to any of these states, with verdicts from the worst to the best of these."""
        # Lost words are kept apart, so that a continuation may leave them out.
        lost = self._machine.lost.intersection(states := frozenset(states))
        members = self._machine.extremes(states - lost) | frozenset(sorted(lost)[:1])
        ranks = sorted(map(WORST_FIRST.index, verdicts))
        verdict = within(WORST_FIRST[ranks[-1]], WORST_FIRST[ranks[0]])
        edge = self._edges.get((members, verdict))
        if edge is None:
            edge = Edge(self, tuple(sorted(members)), verdict)
            self._edges[members, verdict] = edge
        return edge

    @cached_property
    def known_ends(self) -> frozenset[tuple[int, FourValued]]:
        """The state reached and the verdict of each edge of the machine."""
        successors, classes = self._machine.successors, range(self._machine.n_classes)
        ends = {
            (targets[symbol], self._verdict(state, symbol))
            for state, targets in enumerate(successors)
            for symbol in classes
        }
        return frozenset(ends.union((state, self._before) for state in self.start.states))

    def _verdict(self, state: int, symbol: int) -> FourValued:
        machine = self._machine
        outcome = machine.outputs[state][symbol]
        if outcome == KEPT:
            is_safe = machine.successors[state][symbol] in machine.safe
            return "satisfied" if is_safe else "holds so far"
        return "violated" if outcome == VIOLATED else "pending"
