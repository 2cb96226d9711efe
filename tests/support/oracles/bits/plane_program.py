"""A formula as a list of operations on planes: each is done once, and what it gives soon freed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

from rulec.logic.formula import Formula, Proposition
from rulec.logic.semantics import steps_to_settle
from support.oracles.bits.plane_algebra import Algebra, Plane
from support.oracles.bits.temporal_operators import Evaluation

_Place: TypeAlias = int
"""Where a plane lies: that of the first operation at 1. At 0 is the None of ``until``."""

_MOST = 1 << 8
"""The programs of so many formulas are remembered."""


class _Operation(NamedTuple):
    """A method of the algebra, the places of the planes that it takes, and its other arguments."""

    name: str
    takes: tuple[_Place, ...]
    others: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Program:
    """The last of the operations gives the row of a formula at the first instant.

    ``over`` are for each operation the places that are not needed after it. ``settling`` is for how
    many instants values may still change while the last letter is repeated.
    """

    operations: tuple[_Operation, ...]
    over: tuple[tuple[_Place, ...], ...]
    settling: int

    def run(self, algebra: Algebra[Plane]) -> Plane:
        """The row, by the algebra's operations."""
        planes: list[Any] = [None]
        for (name, takes, others), over in zip(self.operations, self.over, strict=True):
            planes.append(getattr(algebra, name)(*[planes[place] for place in takes], *others))
            for place in over:
                planes[place] = None
        row: Plane = planes[-1]
        return row


@lru_cache(maxsize=_MOST)
def program_of(formula: Formula) -> Program:
    """The program of a formula. ValueError as ``Evaluation.at_first``."""
    recorder = _Recorder()
    last = Evaluation(recorder).at_first(formula)
    operations = _needed(recorder.operations, last)
    return Program(tuple(operations), tuple(_over(operations)), steps_to_settle(formula))


class _Recorder:
    """An algebra whose planes are places, which writes down what is done."""

    def __init__(self) -> None:
        self.operations: list[_Operation] = []
        self._places: dict[_Operation, _Place] = {}

    def _record(self, name: str, *takes: _Place, others: tuple[Any, ...] = ()) -> _Place:
        operation = _Operation(name, takes, others)
        if operation not in self._places:
            self.operations.append(operation)
            self._places[operation] = len(self.operations)
        return self._places[operation]

    def given(self, proposition: Proposition) -> _Place:
        return self._record("given", others=(proposition,))

    def constant(self, value: bool) -> _Place:
        return self._record("constant", others=(value,))

    def no(self, one: _Place) -> _Place:
        name, takes, _ = self.operations[one - 1]
        return takes[0] if name == "no" else self._record("no", one)

    def both(self, one: _Place, other: _Place) -> _Place:
        return self._record("both", one, other)

    def either(self, one: _Place, other: _Place) -> _Place:
        return self._record("either", one, other)

    def differ(self, one: _Place, other: _Place) -> _Place:
        return self._record("differ", one, other)

    def ahead(self, one: _Place, steps: int) -> _Place:
        return self._record("ahead", one, others=(steps,))

    def back(self, one: _Place, steps: int) -> _Place:
        return self._record("back", one, others=(steps,))

    def until(self, left: _Place | None, right: _Place) -> _Place:
        return self._record("until", left or 0, right)

    def since(self, left: _Place | None, right: _Place) -> _Place:
        return self._record("since", left or 0, right)

    def given_first(self, proposition: Proposition) -> _Place:
        return self._record("given_first", others=(proposition,))

    def first(self, one: _Place) -> _Place:
        return self._record("first", one)

    def ever(self, one: _Place) -> _Place:
        return self._record("ever", one)

    def opposite(self, row: _Place) -> _Place:
        return self._record("opposite", row)


def _needed(operations: Sequence[_Operation], last: _Place) -> list[_Operation]:
    """Those that lead to the last one, in places of their own."""
    needed = {last}
    for place in range(last, 0, -1):
        if place in needed:
            needed.update(operations[place - 1].takes)
    old = sorted(needed - {0})
    places = {0: 0} | {place: new for new, place in enumerate(old, start=1)}
    return [
        operation._replace(takes=tuple([places[one] for one in operation.takes]))
        for operation in [operations[place - 1] for place in old]
    ]


def _over(operations: Sequence[_Operation]) -> list[tuple[_Place, ...]]:
    """For each operation the places that none takes after it."""
    seen: set[_Place] = {0}
    over: list[tuple[_Place, ...]] = []
    for operation in reversed(operations):
        over.append(tuple({*operation.takes} - seen))
        seen.update(operation.takes)
    return over[::-1]
