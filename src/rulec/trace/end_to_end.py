"""Drives laid end to end in arrays with a column per state: what looks back or ahead stays in one.

Everything that is said of a single state is said of all of them by the same calls. Only what looks
at other states has to know where a drive begins and ends; for one drive that is the whole array.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

_Flags = NDArray[bool_]
_Columns = NDArray[intp]


class UnlikeDrivesError(Exception):
    """Drives that say different names are not laid end to end."""


@dataclass(frozen=True, eq=False)
class EndToEnd:
    """Where drives are in ``n_states`` columns, the last axis of arrays; each begins at a bound.

    ``bounds`` are where they begin, and where the last one ends.
    """

    bounds: Sequence[int]

    @staticmethod
    def of_one(n_states: int) -> EndToEnd:
        """One drive."""
        return EndToEnd((0, n_states))

    @property
    def n_drives(self) -> int:
        """How many drives there are."""
        return len(self.bounds) - 1

    @property
    def n_states(self) -> int:
        """How many states they have together."""
        return self.bounds[-1]

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The columns of each."""
        return tuple(map(slice, self.bounds[:-1], self.bounds[1:]))

    @cached_property
    def lengths(self) -> _Columns:
        """The number of states of each drive."""
        return np.array(self.bounds[1:], dtype=intp) - self.begins

    @cached_property
    def columns(self) -> _Columns:
        """All columns."""
        return np.arange(self.n_states)

    @cached_property
    def begins(self) -> _Columns:
        """The first column of each drive."""
        return np.array(self.bounds[:-1], dtype=intp)

    @cached_property
    def number(self) -> _Columns:
        """The number of the drive, by column."""
        return np.arange(self.n_drives).repeat(self.lengths)

    @cached_property
    def first(self) -> _Columns:
        """The first column of the drive, by column."""
        return self.spread(self.begins)

    @cached_property
    def end(self) -> _Columns:
        """The column behind the last one of the drive, by column."""
        return self.spread(self.begins + self.lengths)

    @cached_property
    def begins_here(self) -> _Flags:
        """Flags of the columns in which drives begin."""
        flags = np.zeros(self.n_states, dtype=bool)
        flags[self.begins] = True
        return flags

    def latest(self, flags: _Flags) -> _Columns:
        """The last state up to each in which a flag holds; the one before the drive for none."""
        # What is between two flags is sooner laid out than found state by state
        edges = np.concatenate(((-1,), flags.ravel().nonzero()[0], (flags.size,)))
        lengths = edges[1:] - edges[:-1]
        lengths[0] -= 1
        latest = self._in_rows(edges[:-1].repeat(lengths), flags)
        return np.maximum(latest, self.first - 1, out=latest)

    def next_state(self, flags: _Flags, beyond: int = 0) -> _Columns:
        """The first state from each on in which a flag holds.

        For none it is the one behind the drive, and so many ``beyond``.
        """
        edges = np.concatenate(((-1,), flags.ravel().nonzero()[0], (flags.size - 1,)))
        lengths = edges[1:] - edges[:-1]
        # Behind the last flag none is before any end
        edges[-1] += self.n_states + 1
        states = self._in_rows(edges[1:].repeat(lengths), flags)
        if beyond:
            return np.where(states < self.end, states, self.end + beyond)
        return np.minimum(states, self.end, out=states)

    def _in_rows(self, places: NDArray[intp], flags: _Flags) -> _Columns:
        """Columns in each row, of places in all rows laid flat."""
        if flags.ndim == 1:
            return places
        begins = np.arange(0, flags.size, self.n_states).reshape(*flags.shape[:-1], 1)
        return places.reshape(flags.shape) - begins

    def within(self, flags: _Flags, steps: int, *, around: bool = False) -> _Flags:
        """Flags that hold at a state or at most ``steps`` states later, or also earlier."""
        if not flags.any():
            return flags
        soon: _Flags = flags & (steps >= 0)
        for shift, is_inside in self._shifts(steps):
            soon[..., :-shift] |= soon[..., shift:] & is_inside
        return soon | self.within_last(flags, steps) if around else soon

    def within_last(self, flags: _Flags, steps: int) -> _Flags:
        """Flags that hold at a state or at most ``steps`` states before it."""
        held: _Flags = flags & (steps >= 0)
        for shift, is_inside in self._shifts(steps):
            held[..., shift:] |= held[..., :-shift] & is_inside
        return held

    def most_of_last(self, values: NDArray[Any], steps: int) -> NDArray[Any]:
        """The greatest value at a state and at most ``steps`` states before it."""
        most: NDArray[Any] = values.copy()
        for shift, is_inside in self._shifts(steps):
            earlier, later = most[..., :-shift], most[..., shift:]
            most[..., shift:] = np.where(is_inside, np.maximum(earlier, later), later)
        return most

    def _shifts(self, steps: int) -> Iterator[tuple[int, _Flags]]:
        """Shifts that join each state with so many to one side of it, each twice as many as before.

        With flags of pairs of columns so far apart that are of one drive.
        """
        # Who looks farther than the longest drive sees no more
        count, wanted = 1, min(steps, int(self.lengths.max()) - 1) + 1
        while count < wanted:
            shift = min(count, wanted - count)
            yield shift, self.number[shift:] == self.number[:-shift]
            count += shift

    def before(self, values: NDArray[Any]) -> NDArray[Any]:
        """The values one state before, in a drive's first state its own."""
        shifted = np.empty_like(values)
        shifted[..., 1:] = values[..., :-1]
        shifted[..., self.begins] = values[..., self.begins]
        return shifted

    def after(self, values: NDArray[Any]) -> NDArray[Any]:
        """The values one state later, in a drive's last state its own."""
        shifted = np.empty_like(values)
        shifted[..., :-1] = values[..., 1:]
        last = self.begins[1:] - 1
        shifted[..., last] = values[..., last]
        shifted[..., -1] = values[..., -1]
        return shifted

    def enters(self, flags: _Flags) -> _Flags:
        """Flags of states in which a flag holds that did not one state before."""
        entered: _Flags = flags & ~self.before(flags)
        return entered

    def changes(self, values: NDArray[Any]) -> _Flags:
        """Flags of states in which a value is another one than one state before."""
        changed: _Flags = values != self.before(values)
        return changed

    def any(self, flags: _Flags) -> _Flags:
        """Whether a flag holds in any state of a drive, in all its columns."""
        return self.spread(np.logical_or.reduceat(flags, self.begins, axis=-1))

    def all(self, flags: _Flags) -> _Flags:
        """Whether a flag holds in all states of a drive, in all its columns."""
        return self.spread(np.logical_and.reduceat(flags, self.begins, axis=-1))

    def count_of_last(self, flags: _Flags, steps: int) -> _Columns:
        """In how many of so many states up to each, it among them, a flag holds."""
        sums = np.zeros((*flags.shape[:-1], self.n_states + 1), dtype=intp)
        flags.cumsum(axis=-1, out=sums[..., 1:])
        since = np.maximum(self.columns + 1 - steps, self.first)
        counts: _Columns = sums[..., 1:] - sums[..., since]
        return counts

    def each(self, function: Callable[[slice], NDArray[Any]], axis: int = -1) -> NDArray[Any]:
        """What a function finds for the columns of each drive, laid end to end."""
        results = [function(columns) for columns in self.slices]
        return results[0] if len(results) == 1 else np.concatenate(results, axis=axis)

    def agreed(self, flags: Sequence[Any]) -> bool:
        """A flag that all drives share. Raises UnlikeDrivesError if they do not."""
        values = {bool(flag) for flag in flags}
        if len(values) > 1:
            raise UnlikeDrivesError
        return values.pop()

    def spread(self, values: Sequence[Any] | NDArray[Any]) -> NDArray[Any]:
        """A value for each drive, in all its columns."""
        return np.asarray(values).repeat(self.lengths, axis=-1)

    def those(self, drives: _Flags) -> Iterator[tuple[int, slice]]:
        """The numbers and the columns of some drives, flagged by column."""
        for number in drives[self.begins].nonzero()[0].tolist():
            yield number, self.slices[number]
