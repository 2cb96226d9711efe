"""Four-valued verdicts on running traces, and Mealy monitors as linked edges.

RV-LTL: A. Bauer, M. Leucker, C. Schallhart, "Comparing LTL semantics for runtime verification",
Journal of Logic and Computation 20(3), 2010.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from rulec.automata.mealy_monitor import MealyMonitor

FourValued: TypeAlias = Literal["satisfied", "violated", "holds so far", "pending"]
"""RV-LTL's true, false, presumably true and presumably false.

``satisfied`` and ``violated`` are final, however the trace goes on, and if it ends here. Of the
other two the end decides: if it came now, what ``holds so far`` would be kept, and what is
``pending`` violated.
"""


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
    rows: list[list[MonitorEdge]] = [[] for _ in machine.successors]
    edges: dict[tuple[int, FourValued], MonitorEdge] = {}
    for state, row in enumerate(rows):
        for target, accepted in zip(machine.successors[state], machine.outputs[state], strict=True):
            verdict = four_valued(machine, target, accepted=accepted)
            if (target, verdict) not in edges:
                edges[target, verdict] = MonitorEdge(rows[target], target, verdict)
            row.append(edges[target, verdict])
    before_all: FourValued = "satisfied" if machine.accepting_sink == 0 else "holds so far"
    return MonitorEdge(rows[0], 0, before_all), edges


def four_valued(machine: MealyMonitor, state: int, *, accepted: bool) -> FourValued:
    """Four-valued verdict (RV-LTL) on a word that leads to a state."""
    # A finite word may be accepted if it ends here, though no longer one is: `weak next false`.
    if accepted:
        return "satisfied" if state == machine.accepting_sink else "holds so far"
    return "violated" if state == machine.rejecting_sink else "pending"


def conjunction(verdicts: Iterable[FourValued]) -> FourValued:
    """The verdict on several rules together; nothing at all is satisfied."""
    distinct = set(verdicts)
    return next((verdict for verdict in _WORST_FIRST if verdict in distinct), "satisfied")


_WORST_FIRST: tuple[FourValued, ...] = ("violated", "pending", "holds so far")
