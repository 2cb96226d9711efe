"""A recorded drive: its trace, where it was, and what decided its signals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import hypot
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.diagnostics import RulecError
from rulec.logic.formula import Relation
from rulec.monitoring.explain.margins import Margin
from rulec.trace import Trace
from rulec.trace.cells import Cells
from rulec.trace.trace_arrays import TraceArrays
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True, eq=False)
class DecidedBy:
    """The numbers by which a signal about objects was decided: whether a value reaches a limit.

    ``quantity`` names the value. ``rows`` has the objects' rows in arrays of which only ``cells``
    were compared; the drive has the ``columns`` of these arrays. The errors of values and limits
    are independent.
    """

    quantity: str
    unit: str
    rows: Mapping[str, int]
    columns: slice
    cells: Cells
    values: Floats
    limits: Floats
    value_error: float
    limit_errors: Floats

    def margin(self, item: str, state: int) -> Margin | None:
        """The margin for an object in a state; None if its numbers were not compared there."""
        row = self.rows.get(item)
        at = None if row is None else self.cells.number(row, self.columns.start + state)
        if at is None or np.isnan(self.values[at]):
            return None
        value, limit = float(self.values[at]), float(self.limits[at])
        relation: Relation = ">=" if value >= limit else "<"
        limit_error = float(self.limit_errors[at])
        return Margin(
            f"{self.quantity}({item})",
            value=value,
            relation=relation,
            limit=limit,
            unit=self.unit,
            value_error=self.value_error,
            limit_error=limit_error,
            error=hypot(self.value_error, limit_error),
        )


class Place(NamedTuple):
    """A place in the recording's coordinates (m), and the lanelet of ego's lane there."""

    x: float
    y: float
    lanelet: str


@dataclass(frozen=True, slots=True, eq=False)
class DrivePlaces(Sequence[Place]):
    """Places by state, built on demand.

    ``numbers`` has for each state the index of its lanelet in ``lanelets``.
    """

    x: Floats
    y: Floats
    numbers: NDArray[np.intp]
    lanelets: tuple[str, ...]

    def part(self, states: slice) -> DrivePlaces:
        """The places of some states."""
        return DrivePlaces(self.x[states], self.y[states], self.numbers[states], self.lanelets)

    def mirrored(self) -> DrivePlaces:
        """The same places in the coordinates of ``mirrored_recording``, or back."""
        return DrivePlaces(self.x, 0.0 - self.y, self.numbers, self.lanelets)

    def __len__(self) -> int:
        return len(self.x)

    @overload
    def __getitem__(self, state: int) -> Place: ...

    @overload
    def __getitem__(self, state: slice) -> tuple[Place, ...]: ...

    def __getitem__(self, state: int | slice) -> Place | tuple[Place, ...]:
        if isinstance(state, slice):
            return tuple([self[k] for k in range(*state.indices(len(self)))])
        x, y = round(float(self.x[state]), 2), round(float(self.y[state]), 2)
        return Place(x, y, self.lanelets[int(self.numbers[state])])

    def __eq__(self, other: object) -> bool:
        """Whether they are the same places."""
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True)
class Drive:
    """A drive of ``ego`` as a trace that starts at ``start_s`` (s of the recording).

    Its states are built from ``arrays`` on first use. ``kinds`` are the Python types of the signals
    that the recording supplies, whether or not there is any object to have them; ``decided_by`` has
    the numbers behind Boolean signals. ``places`` are where ego's middle is in each state. ``whom``
    has, for signals of the world, the ids of the participants that cause their value in each state.
    ``otherwise`` is the trace if participants of unknown type near ego had a type that they may
    have, once for each type.
    """

    __repr__ = short_repr

    ego: str
    start_s: float
    arrays: TraceArrays
    kinds: Mapping[str, type]
    decided_by: Mapping[str, DecidedBy] = field(default_factory=dict, compare=False)
    places: Sequence[Place] = field(default=(), compare=False)
    whom: Mapping[str, Sequence[tuple[str, ...]]] = field(default_factory=dict, compare=False)
    otherwise: tuple[TraceArrays, ...] = field(default=(), compare=False, repr=False)

    @cached_property
    def trace(self) -> Trace:
        """The trace with its states."""
        return self.arrays.trace()

    @property
    def words(self) -> frozenset[str]:
        """The names of the signals that the recording supplies, whatever faults may have cost."""
        return frozenset(self.kinds).union(self.arrays.faults)

    @property
    def first_step(self) -> int:
        """The recording's time step at the first state."""
        return round(self.start_s / self.arrays.step_s)

    def time_s(self, state: int | None) -> float:
        """The time (s of the recording) of a state; None means the last state."""
        number = self.arrays.n_states - 1 if state is None else state
        return round(self.start_s + number * self.arrays.step_s, 9)


@dataclass(frozen=True, slots=True)
class NoDrive:
    """A vehicle ``ego`` that has no drive, and why; ``fault`` is the one of rulec that cost it."""

    ego: str
    why: str
    fault: RulecError | None = None
