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

``satisfied`` and ``violated`` are final, however the trace continues, also if it ends now. Of the
other two, ``holds so far`` would be kept if the trace ended now, and ``pending`` violated.
"""


class VerdictRange(NamedTuple):
    """The best and worst verdict that is possible with unknown values; they differ."""

    best: FourValued
    worst: FourValued

    def __str__(self) -> str:
        return f"{self.worst} to {self.best}"


RunningVerdict: TypeAlias = "FourValued | VerdictRange"
"""A known verdict, or a range that contains it."""

LetterClass: TypeAlias = int
"""A class of letters; numbers beyond a rule's classes stand for a set of classes.

``UncertainSteps`` numbers the sets: the garbage collector tracks sets, but not numbers.
"""


def best_of(verdict: RunningVerdict) -> FourValued:
    """The best possible verdict."""
    return verdict.best if isinstance(verdict, VerdictRange) else verdict


def worst_of(verdict: RunningVerdict) -> FourValued:
    """The worst possible verdict."""
    return verdict.worst if isinstance(verdict, VerdictRange) else verdict


def within(best: FourValued, worst: FourValued) -> RunningVerdict:
    """The verdict that lies between these two."""
    return best if best == worst else VerdictRange(best, worst)


@dataclass(frozen=True, slots=True, eq=False)
class MonitorEdge:
    """An edge of a monitor: the state reached, and the four-valued verdict.

    ``successors`` has an edge for each letter class that may come next. Equal edges of one monitor
    are identical objects.
    """

    successors: list[MonitorEdge]
    state: int
    verdict: FourValued


def linked_edges(
    machine: MealyMonitor,
) -> tuple[MonitorEdge, dict[tuple[int, FourValued], MonitorEdge]]:
    """The start of a monitor, before its first letter, and its edges.

    The edges are given by the state reached and the verdict.
    """
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
    """The edges that leave each state, and all edges by state reached and verdict."""
    rows: list[list[MonitorEdge]] = [[] for _ in successors]
    edges: dict[tuple[int, FourValued], MonitorEdge] = {}
    for row, targets, said in zip(rows, successors, verdicts, strict=True):
        for target, verdict in zip(targets, said, strict=True):
            if (target, verdict) not in edges:
                edges[target, verdict] = MonitorEdge(rows[target], target, verdict)
            row.append(edges[target, verdict])
    return rows, edges


def four_valued(machine: MealyMonitor, state: int, accepted: bool) -> FourValued:
    """The four-valued verdict (RV-LTL) on a word that leads to a state."""
    # A word that ends here may be accepted although no longer word is: `weak next false`.
    if accepted:
        return "satisfied" if state == machine.accepting_sink else "holds so far"
    return "violated" if state == machine.rejecting_sink else "pending"


def conjunction(verdicts: Iterable[RunningVerdict]) -> RunningVerdict:
    """The verdict on several rules together; without rules it is satisfied.

    Each verdict may turn out anywhere in its range, independently of the others.
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
    """The states without the rejecting sink, if no kept word leads there."""
    sink = machine.rejecting_sink
    rows = zip(machine.successors, machine.outputs, strict=True)
    if any(kept and target == sink for row in rows for target, kept in zip(*row, strict=True)):
        return states
    return states - {sink}
