"""Stretches of states in which something holds, certainly or possibly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.trace.partly_known.partly_known_values import Truth


@dataclass(frozen=True, slots=True, eq=False)
class Stretches:
    """Maximal stretches of states, ``first`` to ``last`` (both included), in ``rows``.

    They are sorted by row, and within a row by time.
    """

    rows: Indices
    first: Indices
    last: Indices

    def __len__(self) -> int:
        return len(self.rows)

    def of_rows(self, rows: Indices) -> Stretches:
        """The stretches of some rows (ascending), with these rows renumbered from 0."""
        place = np.minimum(np.searchsorted(rows, self.rows), len(rows) - 1)
        own = rows[place] == self.rows
        return Stretches(place[own], self.first[own], self.last[own])

    def per_row(self, n_rows: int, which: Flags | None = None) -> Indices:
        """How many stretches each row has: of all, or of those with a flag."""
        result: Indices = np.bincount(
            self.rows if which is None else self.rows[which], minlength=n_rows
        )
        return result

    def with_some(self, flags: Flags) -> Flags:
        """For each stretch whether some of its states has a flag (rows x states)."""
        if not len(self):
            return np.zeros(0, dtype=bool)
        n_states = flags.shape[1]
        before = np.concatenate([[0], np.cumsum(flags.ravel())])
        begin, end = self.rows * n_states + self.first, self.rows * n_states + self.last + 1
        result: Flags = before[end] > before[begin]
        return result


def stretches_of(flags: Flags) -> Stretches:
    """The stretches of states that have a flag (rows x states)."""
    edges = np.zeros((flags.shape[0], flags.shape[1] + 1), dtype=np.int8)
    edges[:, :-1] += flags
    edges[:, 1:] -= flags
    rows, first = np.nonzero(edges > 0)
    _, behind = np.nonzero(edges < 0)
    return Stretches(rows, first, behind - 1)


def _with_states_between(inner: Stretches, outer: Stretches, n_states: int) -> Stretches:
    """Stretches that lie in others, of which they share all states among them."""
    begins = outer.rows * n_states + outer.first
    within = np.searchsorted(begins, inner.rows * n_states + inner.first, side="right") - 1
    is_first = np.append(True, within[1:] != within[:-1])[: len(inner)]
    first = np.where(is_first, outer.first[within], inner.first)
    is_last = np.append(is_first[1:], True)[: len(inner)]
    last = np.where(is_last, outer.last[within], np.append(inner.first[1:], 0)[: len(inner)] - 1)
    return Stretches(inner.rows, first, last)


def opportunity_stretches(truth: Truth) -> tuple[Stretches, Stretches]:
    """The certain opportunities, and the most that there may be.

    A stretch in which something possibly holds is one certain opportunity if it certainly holds
    somewhere in it. At most there are as many opportunities in it as stretches in which it
    certainly holds, and one if there is none: what is not known is not thought to change more often
    than it has to. Each such stretch takes the states up to the next one, and the first in a
    stretch also those before it, as something may hold there, too.
    """
    joined = stretches_of(truth.possible)
    for_sure = joined.with_some(truth.sure)
    certain = _with_states_between(stretches_of(truth.sure), joined, truth.sure.shape[1])
    doubtful = Stretches(*[part[~for_sure] for part in (joined.rows, joined.first, joined.last)])
    at_least = Stretches(*[part[for_sure] for part in (joined.rows, joined.first, joined.last)])
    at_most = Stretches(
        np.concatenate([certain.rows, doubtful.rows]),
        np.concatenate([certain.first, doubtful.first]),
        np.concatenate([certain.last, doubtful.last]),
    )
    return at_least, at_most


def most_violated(truth: Truth, breached: Flags) -> Indices:
    """For each row the most opportunities with a breach in one of their states (rows x states).

    There are at most as many as in ``opportunity_stretches``. What may hold between two certain
    ones belongs to the one, the other, both or neither, or joins them, whichever is worst.
    """
    _, at_most = opportunity_stretches(truth)
    joined, sure = stretches_of(truth.possible), truth.sure
    begins = joined.rows * sure.shape[1] + joined.first
    within = np.searchsorted(begins, at_most.rows * sure.shape[1] + at_most.first, side="right") - 1
    n_most = np.bincount(within, minlength=len(joined))
    # In others each state belongs to one opportunity only.
    is_mixed = (n_most > 1) & joined.with_some(breached & ~sure)
    counts = at_most.per_row(len(sure), at_most.with_some(breached) & ~is_mixed[within])
    for one in np.flatnonzero(is_mixed):
        row, states = joined.rows[one], slice(joined.first[one], joined.last[one] + 1)
        counts[row] += _most_violated(sure[row, states], breached[row, states], int(n_most[one]))
    return counts


def _most_violated(sure: Flags, breached: Flags, most: int) -> int:
    """The most violated of ``most`` opportunities or fewer, where one may hold in all states."""
    # By the number of opportunities so far: the most violated ones if none holds now, or one that
    # is not violated, or one that is.
    none = np.full(most + 1, -np.inf)
    outside, kept, violated = none.copy(), none, none
    outside[0] = 0.0
    for is_sure, breach in zip(sure.tolist(), breached.tolist(), strict=True):
        ended = np.maximum(outside, np.maximum(kept, violated + 1))
        begun = np.maximum(np.append(-np.inf, outside[:-1]), kept)
        kept, violated = (none, np.maximum(begun, violated)) if breach else (begun, violated)
        outside = none if is_sure else ended
    return int(max(outside.max(), kept.max(), violated.max() + 1))
