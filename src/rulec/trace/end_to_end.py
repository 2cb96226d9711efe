"""Drives laid end to end in arrays with a column per state, and operations that respect their ends.

What concerns single states is computed for all drives by the same calls. Only operations that look
at other states need to know where a drive begins and ends; a single drive fills the whole array.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Indices


class UnlikeDrivesError(Exception):
    """Drives that provide different names: they cannot be laid end to end."""


@dataclass(frozen=True, eq=False)
class EndToEnd:
    """Where each drive lies in the ``n_states`` columns, the last axis of arrays.

    ``bounds`` are the columns where the drives begin, and the end of the last one.
    """

    bounds: Sequence[int]

    @staticmethod
    def of_one(n_states: int) -> EndToEnd:
        """The columns of a single drive."""
        return EndToEnd((0, n_states))

    @property
    def n_drives(self) -> int:
        """The number of drives."""
        return len(self.bounds) - 1

    @property
    def n_states(self) -> int:
        """The number of states of all drives together."""
        return self.bounds[-1]

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """The columns of each drive."""
        return tuple(map(slice, self.bounds[:-1], self.bounds[1:]))

    @cached_property
    def lengths(self) -> Indices:
        """The number of states of each drive."""
        return np.array(self.bounds[1:], dtype=intp) - self.begins

    @cached_property
    def columns(self) -> Indices:
        """All columns."""
        return np.arange(self.n_states)

    @cached_property
    def begins(self) -> Indices:
        """The first column of each drive."""
        return np.array(self.bounds[:-1], dtype=intp)

    @cached_property
    def number(self) -> Indices:
        """The index of the drive, by column."""
        return np.arange(self.n_drives).repeat(self.lengths)

    @cached_property
    def first(self) -> Indices:
        """The first column of the drive, by column."""
        return self.spread(self.begins)

    @cached_property
    def end(self) -> Indices:
        """The column after the drive's last one, by column."""
        return self.spread(self.begins + self.lengths)

    @cached_property
    def begins_here(self) -> Flags:
        """Mask of the columns in which drives begin."""
        flags = np.zeros(self.n_states, dtype=bool)
        flags[self.begins] = True
        return flags

    def latest(self, flags: Flags) -> Indices:
        """For each column, the last up to it with a flag; if none, the one before the drive."""
        # Repeating a value for each gap between flags is faster than searching state by state
        edges = np.concatenate(((-1,), flags.ravel().nonzero()[0], (flags.size,)))
        lengths = edges[1:] - edges[:-1]
        lengths[0] -= 1
        latest = self._in_rows(edges[:-1].repeat(lengths), flags)
        return np.maximum(latest, self.first - 1, out=latest)

    def next_state(self, flags: Flags, beyond: int = 0) -> Indices:
        """For each state the column of the first state, from it on, where a flag holds.

        If there is none in its drive, the column after the drive's last one plus ``beyond``.
        """
        edges = np.concatenate(((-1,), flags.ravel().nonzero()[0], (flags.size - 1,)))
        lengths = edges[1:] - edges[:-1]
        # After the last flag: larger than every drive's end
        edges[-1] += self.n_states + 1
        states = self._in_rows(edges[1:].repeat(lengths), flags)
        if beyond:
            return np.where(states < self.end, states, self.end + beyond)
        return np.minimum(states, self.end, out=states)

    def _in_rows(self, places: NDArray[intp], flags: Flags) -> Indices:
        """Columns within each row, from indices in the flattened array."""
        if flags.ndim == 1:
            return places
        begins = np.arange(0, flags.size, self.n_states).reshape(*flags.shape[:-1], 1)
        return places.reshape(flags.shape) - begins

    def runs(self, flags: Flags) -> Iterator[tuple[int, int]]:
        """The first column of each run of a flag within a drive, and the one after its last."""
        firsts = (flags & (self.begins_here | ~self.before(flags))).nonzero()[0]
        return zip(firsts.tolist(), self.next_state(~flags)[firsts].tolist(), strict=True)

    def within(self, flags: Flags, steps: int, *, around: bool = False) -> Flags:
        """Mask of states with a flag then or up to ``steps`` later; ``around``: or earlier."""
        if not flags.any():
            return flags
        soon: Flags = flags & (steps >= 0)
        for shift, is_inside in self._shifts(steps):
            soon[..., :-shift] |= soon[..., shift:] & is_inside
        return soon | self.within_last(flags, steps) if around else soon

    def within_last(self, flags: Flags, steps: int) -> Flags:
        """Mask of states where a flag holds then or up to ``steps`` states earlier."""
        held: Flags = flags & (steps >= 0)
        for shift, is_inside in self._shifts(steps):
            held[..., shift:] |= held[..., :-shift] & is_inside
        return held

    def most_of_last(self, values: NDArray[Any], steps: int) -> NDArray[Any]:
        """The greatest value at each state and up to ``steps`` states before it."""
        most: NDArray[Any] = values.copy()
        for shift, is_inside in self._shifts(steps):
            earlier, later = most[..., :-shift], most[..., shift:]
            most[..., shift:] = np.where(is_inside, np.maximum(earlier, later), later)
        return most

    def _shifts(self, steps: int) -> Iterator[tuple[int, Flags]]:
        """Shifts, doubling, that together join each state with ``steps`` states on one side of it.

        With each comes a mask of the pairs of columns that far apart that belong to the same drive.
        """
        # A window longer than the longest drive adds nothing
        count, wanted = 1, min(steps, int(self.lengths.max()) - 1) + 1
        while count < wanted:
            shift = min(count, wanted - count)
            yield shift, self.number[shift:] == self.number[:-shift]
            count += shift

    def before(self, values: NDArray[Any]) -> NDArray[Any]:
        """Each state's value one state earlier; in a drive's first state its own value."""
        shifted = np.empty_like(values)
        shifted[..., 1:] = values[..., :-1]
        shifted[..., self.begins] = values[..., self.begins]
        return shifted

    def after(self, values: NDArray[Any]) -> NDArray[Any]:
        """Each state's value one state later; in a drive's last state its own value."""
        shifted = np.empty_like(values)
        shifted[..., :-1] = values[..., 1:]
        last = self.begins[1:] - 1
        shifted[..., last] = values[..., last]
        shifted[..., -1] = values[..., -1]
        return shifted

    def enters(self, flags: Flags) -> Flags:
        """Mask of states where a flag holds, but not one state earlier; never a drive's first."""
        entered: Flags = flags & ~self.before(flags)
        return entered

    def changes(self, values: NDArray[Any]) -> Flags:
        """Mask of states whose value differs from the previous one; never a drive's first state."""
        changed: Flags = values != self.before(values)
        return changed

    def any(self, flags: Flags) -> Flags:
        """Whether a flag holds in any state of a drive, by column."""
        return self.spread(np.logical_or.reduceat(flags, self.begins, axis=-1))

    def all(self, flags: Flags) -> Flags:
        """Whether a flag holds in all states of a drive, by column."""
        return self.spread(np.logical_and.reduceat(flags, self.begins, axis=-1))

    def count_of_last(self, flags: Flags, steps: int) -> Indices:
        """In how many of the ``steps`` states up to and including each one a flag holds."""
        sums = np.zeros((*flags.shape[:-1], self.n_states + 1), dtype=intp)
        flags.cumsum(axis=-1, out=sums[..., 1:])
        since = np.maximum(self.columns + 1 - steps, self.first)
        counts: Indices = sums[..., 1:] - sums[..., since]
        return counts

    def each(self, function: Callable[[slice], NDArray[Any]], axis: int = -1) -> NDArray[Any]:
        """A function's results for the columns of each drive, concatenated."""
        results = [function(columns) for columns in self.slices]
        return results[0] if len(results) == 1 else np.concatenate(results, axis=axis)

    def agreed(self, flags: Sequence[Any]) -> bool:
        """The flag's value that all drives share. Raises UnlikeDrivesError if they differ."""
        values = {bool(flag) for flag in flags}
        if len(values) > 1:
            raise UnlikeDrivesError
        return values.pop()

    def spread(self, values: Sequence[Any] | NDArray[Any]) -> NDArray[Any]:
        """Values of the drives, repeated in all columns of each."""
        return np.asarray(values).repeat(self.lengths, axis=-1)

    def those(self, drives: Flags) -> Iterator[tuple[int, slice]]:
        """The index and the columns of each drive marked in ``drives``, a mask by column."""
        for number in drives[self.begins].nonzero()[0].tolist():
            yield number, self.slices[number]
