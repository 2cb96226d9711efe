"""What can be said of a trace that is still running."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from rulec.automata.mealy_monitor import MealyMonitor

Prefix: TypeAlias = Literal["satisfied", "violated", "holds so far", "pending"]
"""``satisfied`` and ``violated`` are final, however the trace goes on, and if it ends here.

Of the other two the end decides: if it came now, what ``holds so far`` would be kept, and what is
``pending`` violated.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A machine behind a letter: the state that it led to, and the verdict as of this letter.

    ``onward`` has an edge for each class of letters that may come next. Edges of one machine that
    are alike are identical.
    """

    onward: list[Edge]
    state: int
    verdict: Prefix


@dataclass(frozen=True, slots=True)
class VerdictLinks:
    """A machine as edges that lead to edges.

    Before its first letter a machine is at ``start``. ``edges`` are all others, by the state that
    they lead to and the verdict there.
    """

    start: Edge
    edges: dict[tuple[int, Prefix], Edge]


def linked(machine: MealyMonitor) -> VerdictLinks:
    """The edges of a machine."""
    rows: list[list[Edge]] = [[] for _ in machine.successors]
    edges: dict[tuple[int, Prefix], Edge] = {}
    for state, row in enumerate(rows):
        for target, accepted in zip(machine.successors[state], machine.outputs[state], strict=True):
            verdict = prefix(machine, target, accepted=accepted)
            if (target, verdict) not in edges:
                edges[target, verdict] = Edge(rows[target], target, verdict)
            row.append(edges[target, verdict])
    return VerdictLinks(
        Edge(rows[0], 0, "satisfied" if machine.accepting_sink == 0 else "holds so far"), edges
    )


def prefix(machine: MealyMonitor, state: int, *, accepted: bool) -> Prefix:
    """What is known of a word that has led to a state, and is accepted or not if it ends here."""
    # A finite word may be accepted if it ends here, though no longer one is: `weak next false`.
    if accepted:
        return "satisfied" if state == machine.accepting_sink else "holds so far"
    return "violated" if state == machine.rejecting_sink else "pending"


def together(verdicts: Iterable[Prefix]) -> Prefix:
    """The verdict on all of several; nothing at all is satisfied."""
    found = set(verdicts)
    for worst in _WORST_FIRST:
        if worst in found:
            return worst
    return "satisfied"


_WORST_FIRST: tuple[Prefix, ...] = ("violated", "pending", "holds so far")
