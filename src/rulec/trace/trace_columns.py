"""Many traces as columns, one array per name.

The states of all traces are stored in *time-major* order: the first states of all traces, then the
second states of those that have one, and so on, longer traces first. So the states of one step are
adjacent, whatever the traces' lengths, and there is no padding.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.trace.trace_model import State
from rulec.value_display import short_repr

Key = tuple[str, tuple[str, ...]]
"""A vocabulary name and the objects it is about."""

Array = NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Positions of the states of many traces in a column.

    ``lengths`` (int64, one per trace) are the traces' numbers of states: 1 or more, in descending
    order. ``starts`` (int64, one more than the longest trace has states): the states of step t are
    at ``starts[t]`` up to before ``starts[t + 1]``, that of trace i at ``starts[t] + i``.
    """

    lengths: NDArray[np.int64]
    starts: NDArray[np.int64]

    @property
    def n_traces(self) -> int:
        """Number of traces."""
        return len(self.lengths)

    @property
    def n_steps(self) -> int:
        """Number of states of the longest trace."""
        return len(self.starts) - 1

    @property
    def n_states(self) -> int:
        """Number of states of all traces."""
        return int(self.starts[-1])

    def active(self, step: int) -> int:
        """Number of traces that have this step; they are the first ones."""
        return int(self.starts[step + 1] - self.starts[step]) if step < self.n_steps else 0

    def places(self, trace: int, first: int = 0, last: int | None = None) -> NDArray[np.int64]:
        """Positions of a trace's states from ``first`` to ``last`` (inclusive), or to its end."""
        end = int(self.lengths[trace]) if last is None else last + 1
        result: NDArray[np.int64] = self.starts[first:end] + trace
        return result

    def traces_at(self, places: NDArray[np.int64]) -> NDArray[np.int64]:
        """The traces whose states are at these positions."""
        steps = self.starts.searchsorted(places, side="right") - 1
        result: NDArray[np.int64] = places - self.starts[steps]
        return result


def layout_of(lengths: Sequence[int] | NDArray[Any]) -> Layout:
    """The layout of traces of these lengths; ValueError if they do not descend."""
    try:
        given = np.asarray(lengths)
        # Dates and fractions are refused; an empty sequence becomes an array of floats
        result = given.astype(np.int64, casting="same_kind" if given.size else "unsafe")
    except (TypeError, ValueError, OverflowError):
        raise ValueError("lengths of traces are whole numbers, such as [4, 4, 3]") from None
    if result.ndim != 1 or (len(result) and result[-1] < 1) or (np.diff(result) > 0).any():
        raise ValueError("lengths of traces descend, and each is at least 1")
    longest = int(result[0]) if len(result) else 0
    # The traces longer than t are active at step t.
    active = len(result) - result[::-1].searchsorted(np.arange(longest), side="right")
    return Layout(result, np.concatenate([[0], active.cumsum()]).astype(np.int64))


@dataclass(frozen=True, slots=True, eq=False)
class TraceColumns:
    """Traces over the same objects.

    ``values`` has an array of ``layout.n_states`` entries for each ``Key``: Booleans (``bool``) for
    a signal, indices into the declared ``values`` (``uint8`` or wider) for an enumeration, numbers
    (``float64``, each standing for the decimal that Python prints for it) for a quantity. A name
    without an array has its declared default in every state. ``objects`` maps object to type;
    ``present`` maps an object that is not always present to its first and last step (from 0,
    inclusive), as in a ``Trace``. States are ``step_s`` seconds apart.

    Where a value is ``unknown``, its entry means nothing; a number known as an interval lies
    between its entries in ``values`` and in ``upper``.
    """

    __repr__ = short_repr

    layout: Layout
    values: Mapping[Key, Array]
    objects: Mapping[str, str] = field(default_factory=dict)
    present: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    step_s: float = 1.0
    unknown: Mapping[Key, NDArray[np.bool_]] = field(default_factory=dict)
    upper: Mapping[Key, NDArray[np.float64]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class TraceCells:
    """Traces whose states are taken from a small set, such as walks through the nodes of a graph.

    ``cells`` (unsigned integers, ``layout.n_states`` of them) are indices into ``states``.
    ``there`` gives for each of these the objects present in it, with their types; it is empty if
    all are present in all. The rest is as in ``TraceColumns``.
    """

    __repr__ = short_repr

    layout: Layout
    cells: Array
    states: tuple[State, ...]
    objects: Mapping[str, str] = field(default_factory=dict)
    present: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    there: tuple[Mapping[str, str], ...] = ()
    step_s: float = 1.0


def smallest_unsigned(n_values: int) -> np.dtype[Any]:
    """The narrowest unsigned integer type that can number ``n_values`` values."""
    return np.min_scalar_type(max(n_values - 1, 0))
