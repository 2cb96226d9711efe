"""Four-valued verdicts on running traces.

RV-LTL: A. Bauer, M. Leucker, C. Schallhart, "Comparing LTL semantics for runtime verification",
Journal of Logic and Computation 20(3), 2010.
"""

from __future__ import annotations

from collections.abc import Iterable
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

ClassSet: TypeAlias = int
"""The classes of letters that a state may have, as bits."""


def best_of(verdict: RunningVerdict) -> FourValued:
    """The best possible verdict."""
    return verdict.best if isinstance(verdict, VerdictRange) else verdict


def worst_of(verdict: RunningVerdict) -> FourValued:
    """The worst possible verdict."""
    return verdict.worst if isinstance(verdict, VerdictRange) else verdict


def within(best: FourValued, worst: FourValued) -> RunningVerdict:
    """The verdict that lies between these two."""
    return best if best == worst else VerdictRange(best, worst)


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
