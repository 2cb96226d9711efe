"""Four-valued verdicts on running traces, and Mealy monitors as linked edges.

RV-LTL: A. Bauer, M. Leucker, C. Schallhart, "Comparing LTL semantics for runtime verification",
Journal of Logic and Computation 20(3), 2010.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

from rulec.automata.mealy_monitor import MealyMonitor

FourValued: TypeAlias = Literal["satisfied", "violated", "holds so far", "pending"]
"""RV-LTL's true, false, presumably true and presumably false.

``satisfied`` and ``violated`` are final, however the trace goes on, and if it ends here. Of the
other two the end decides: if it came now, what ``holds so far`` would be kept, and what is
``pending`` violated.
"""


class VerdictRange(NamedTuple):
    """The best and the worst of a verdict where not all is known; they differ."""

    best: FourValued
    worst: FourValued

    def __str__(self) -> str:
        return f"{self.worst} to {self.best}"


RunningVerdict: TypeAlias = "FourValued | VerdictRange"
"""A verdict that is known, or within which it lies."""

LetterClass: TypeAlias = int
"""A class of letters; beyond a rule's classes a set of them, of which a state has one.

``UncertainSteps`` numbers the sets. Numbers are no concern of the garbage collector, sets are.
"""


def best_of(verdict: RunningVerdict) -> FourValued:
    """The verdict at best."""
    return verdict.best if isinstance(verdict, VerdictRange) else verdict


def worst_of(verdict: RunningVerdict) -> FourValued:
    """The verdict at worst."""
    return verdict.worst if isinstance(verdict, VerdictRange) else verdict


def within(best: FourValued, worst: FourValued) -> RunningVerdict:
    """The verdict that lies between these two."""
    return best if best == worst else VerdictRange(best, worst)


@dataclass(frozen=True, slots=True, eq=False)
class MonitorEdge:
    """Edge of a monitor: the state reached, and the four-valued verdict.

    ``successors`` has an edge for each letter class that may come next. Edges of one monitor that
    are alike are identical.
    """

    successors: list[MonitorEdge]
    state: int
    verdict: FourValued


def linked_edges(
    machine: MealyMonitor,
) -> tuple[MonitorEdge, dict[tuple[int, FourValued], MonitorEdge]]:
    """Where a monitor is before its first letter, and its edges by state reached and verdict."""
    verdicts = [
        [four_valued(machine, *ends) for ends in zip(targets, row, strict=True)]
        for targets, row in zip(machine.successors, machine.outputs, strict=True)
    ]
    rows, edges = edges_between(machine.successors, verdicts)
    before_all: FourValued = "satisfied" if machine.accepting_sink == 0 else "holds so far"
    return MonitorEdge(rows[0], 0, before_all), edges


def edges_between(
    successors: Sequence[Sequence[int]], verdicts: Sequence[Sequence[FourValued]]
) -> tuple[list[list[MonitorEdge]], dict[tuple[int, FourValued], MonitorEdge]]:
    """The edges that leave each state, and all by state reached and verdict."""
    rows: list[list[MonitorEdge]] = [[] for _ in successors]
    edges: dict[tuple[int, FourValued], MonitorEdge] = {}
    for row, targets, said in zip(rows, successors, verdicts, strict=True):
        for target, verdict in zip(targets, said, strict=True):
            if (target, verdict) not in edges:
                edges[target, verdict] = MonitorEdge(rows[target], target, verdict)
            row.append(edges[target, verdict])
    return rows, edges


def four_valued(machine: MealyMonitor, state: int, accepted: bool) -> FourValued:
    """Four-valued verdict (RV-LTL) on a word that leads to a state."""
    # A finite word may be accepted if it ends here, though no longer one is: `weak next false`.
    if accepted:
        return "satisfied" if state == machine.accepting_sink else "holds so far"
    return "violated" if state == machine.rejecting_sink else "pending"


def conjunction(verdicts: Iterable[RunningVerdict]) -> RunningVerdict:
    """The verdict on several rules together; nothing at all is satisfied.

    Each may come out anywhere in its range, whatever the others do.
    """
    distinct = set(verdicts)
    if _FOUR.issuperset(distinct):
        return _worst(distinct)
    return within(_worst(map(best_of, distinct)), _worst(map(worst_of, distinct)))


def _worst(verdicts: Iterable[RunningVerdict]) -> FourValued:
    distinct = set(verdicts)
    return next((verdict for verdict in WORST_FIRST if verdict in distinct), "satisfied")


WORST_FIRST: tuple[FourValued, ...] = ("violated", "pending", "holds so far", "satisfied")
_FOUR = frozenset(WORST_FIRST)


def without_sink(machine: MealyMonitor, states: frozenset[int]) -> frozenset[int]:
    """The states without the one of words that were lost, if no kept word leads there."""
    sink = machine.rejecting_sink
    rows = zip(machine.successors, machine.outputs, strict=True)
    if any(kept and target == sink for row in rows for target, kept in zip(*row, strict=True)):
        return states
    return states - {sink}
